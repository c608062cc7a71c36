/* machine_main.c -- prints what this machine can do: machine [THREADS]. */
#include "machine.h"

#include <stdlib.h>

int main(int argc, char **argv)
{
    struct machine m;

    machine_measure(&m, argc > 1 ? atoi(argv[1]) : 0);
    machine_print(&m);
    return 0;
}
