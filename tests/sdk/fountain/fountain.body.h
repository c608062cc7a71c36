/* fountain.body.h -- of one particle: whether it is past the outlet, and how many copies it leaves. */
leaves = x[0] >= outlet;
copies = 0;
if (!released && x[0] >= inlet) {
    /* Further in one step than the reservoir is long: a copy for each length. */
    copies = (int)floor((x[0] - inlet) / length) + 1;
    released = 1;
}
