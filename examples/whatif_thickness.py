"""How the local exponent depends on thickness, glued and sliding, in two processes."""

from concurrent.futures import ProcessPoolExecutor

import dummydesign


def main():
    with ProcessPoolExecutor(2) as pool:
        found = dummydesign.whatif(
            "4:24:4", [15.5], base="bonded,sliding", force_N=[2, 5], executor=pool, out="thickness"
        )
    for row in found.rows:
        exponents = ", ".join(
            f"{n:.2f} at {force} N" if n is not None else f"{force} N out of reach"
            for force, n in row["exponent_at_N"].items()
        )
        print(f"{row['thickness_mm']:g} mm, {row['base']} base: exponent {exponents}")
    print("report:", found.files["report"])


# processes that are started anew import this file again
if __name__ == "__main__":
    main()
