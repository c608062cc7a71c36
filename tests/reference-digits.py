"""Tables of exact solutions (tests/reference) are compared to their printed digits: in a copy of each table a
number is changed in its last digits, a column at a time, up and down, and the test that reads it must fail."""
import os
import random
import shutil
import subprocess
import sys
import tempfile
from decimal import Decimal

REFERENCE = os.path.join(os.environ["top_srcdir"], "tests", "reference")
PROGRAMS = os.path.join(os.environ["top_builddir"], "tests", "unit")

# Table; program; its test; the columns it compares; units of the tenth digit by which a number is changed. Two
# are caught for certain: the test allows for one, and a table is within half a one. Sedov's tables print the
# radius to ten digits, too, and so allow for what becomes of its rounding.
TABLES = [
    ("riemann_sod", "test_exact", "sods_tube", "rho u p e", 2),
    ("riemann_toro2_123", "test_exact", "toros_123", "rho u p e", 2),
    ("riemann_star_states", "test_exact", "star_states_of_the_table",
     "p_star u_star rho_star_L rho_star_R wave_speeds", 2),
    ("noh", "test_exact", "noh_of_the_table", "rho u p", 2),
    ("sedov_2d_g53", "test_exact_gas", "sedov_2d_of_the_table", "rho u p", 100),
    ("sedov_3d_g53", "test_exact_gas", "sedov_3d_of_the_table", "rho u p", 100),
    ("sedov_alpha", "test_exact_gas", "sedov_alpha_of_the_table", "gamma alpha r2_t1 shock_speed_t1 rho2 u2 p2", 2),
    ("gresho", "test_exact_gas", "gresho_of_the_table", "v_phi p", 2),
    ("taylor_green", "test_exact_liquid", "taylor_green_of_the_table", "vmax Ekin_per_mass", 2),
    ("poiseuille_morris", "test_exact_liquid", "poiseuille_of_the_table", "u", 2),
    ("couette_morris", "test_exact_liquid", "couette_of_the_table", "u", 2),
    ("standing_wave_damping", "test_exact_liquid", "standing_wave_of_the_table",
     "k omega0 T0 beta_approx beta_exact omega_exact Ekin_factor_t10", 2),
    ("elliptical_drop", "test_exact_liquid", "elliptical_drop_of_the_table", "A semi_a_x semi_b_y ab KE_per_rho", 2),
    ("rotating_patch_p0", "test_exact_liquid", "rotating_patch_of_the_table", "p", 2),
    ("cantilever_frequencies", "test_exact_solid", "plate_of_the_table", "kL omega f_Hz T omegaL_over_c0", 2),
    ("hugoniot_symmetric_impact", "test_exact_solid", "impact_of_the_table", "up Us P rho de", 2),
]

chance = random.Random(1)
missed = 0


def run(scratch, program, test):
    """Exit status and output of one test on the tables in the scratch folder."""
    environment = dict(os.environ, top_srcdir=scratch)
    done = subprocess.run([os.path.join(PROGRAMS, program), test], env=environment, capture_output=True, text=True,
                          timeout=60)
    return done.returncode, done.stdout + done.stderr


def changed(cell, units, digits=10):
    number = Decimal(cell)
    return format(number + units * Decimal((0, (1,), number.adjusted() - digits + 1)), "f")


def broken(cell, units):
    """The cell with one number changed. That of speeds, name=speed;..., has eight digits."""
    if "=" not in cell:
        return changed(cell, units)
    waves = cell.split(";")
    k = chance.choice([k for k, wave in enumerate(waves) if Decimal(wave.split("=")[1]) != 0])
    name, speed = waves[k].split("=")
    waves[k] = name + "=" + changed(speed, units, 8)
    return ";".join(waves)


def scale(cell):
    """Of a cell's number; 0 of one that a table need not have right: 0, and the rounding of a sum."""
    return float("inf") if "=" in cell else abs(Decimal(cell))


def choose(rows, k):
    """A row with a number in column k that is not small beside the others."""
    most = max(scale(row[k]) for row in rows)
    return chance.choice([i for i, row in enumerate(rows) if scale(row[k]) > 0 and scale(row[k]) >= most / 1000])


def check(scratch, table, program, test, columns, units):
    global missed
    path = os.path.join(scratch, "tests", "reference", table + ".csv")
    with open(path, encoding="utf-8") as file:
        text = file.read()
    code, out = run(scratch, program, test)
    if code != 0 or "[  PASSED  ] 1 test(s)." not in out:
        missed += 1
        print(f"MISS {table}: {program} {test} does not pass as it is: {out}")
        return 0
    lines = text.splitlines()
    names = lines[1].split(",")
    rows = [line.split(",") for line in lines[2:] if line]
    count = 0
    for column in columns.split():
        k = names.index(column)
        i = choose(rows, k)
        for way in (-units, units):
            row = list(rows[i])
            row[k] = broken(row[k], way)
            with open(path, "w", encoding="utf-8") as file:
                file.write("\n".join(lines[:2] + [",".join(row if r == i else rows[r]) for r in range(len(rows))]) + "\n")
            code, out = run(scratch, program, test)
            if code == 0 or f"[  FAILED  ] {test}" not in out:
                missed += 1
                print(f"MISS {table}: {test} does not see {rows[i][k]} -> {row[k]} ({column}, row {i + 1})")
            count += 1
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return count


with tempfile.TemporaryDirectory() as scratch:
    shutil.copytree(REFERENCE, os.path.join(scratch, "tests", "reference"))
    count = sum(check(scratch, *table) for table in TABLES)
print(f"{len(TABLES)} tables, {count} numbers changed, {missed} missed")
sys.exit(1 if missed else 0)
