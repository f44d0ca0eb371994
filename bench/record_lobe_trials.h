#pragma once

#include <vector>

#include "bench/lobe_harmonics.h"

namespace render2mpeg::bench {

/// Angles that eyes are turned by, and distances of neighbours, that lobes are tried at.
constexpr int turn_count = 5, distance_count = 3;

/// What was kept: the lobe's light alone; with how it changes with the eye; harmonics alone; and the lobe's light with
/// what these say that it changes by.
enum Means {
    lobe_alone,
    slopes,
    harmonics,
    differences = harmonics + tried_orders,
    means_count = differences + tried_orders
};

/// One try: by how much a pixel's luminance was off, and what was known of it before.
struct Trial {
    float error = 0;      ///< of the pixel's luminance
    float lobe_part = 0;  ///< of the lobe in it, as the record says
};
/// Of a roughness: by means, and by turn, then by distance, of one neighbour and of the mean of four.
struct Trials {
    std::vector<Trial> of[means_count][turn_count + 2 * distance_count];
    Basis basis = Basis::stretched;
};

/// Prints, by means, what share of pixels is served, and the median error.
void print_tables(const Trials& trials, int roughness);

}  // namespace render2mpeg::bench
