#pragma once
// Sums and means over the pictures of one type.
#include <cstdint>
#include <vector>

#include "encoder/av/inspect.h"

namespace render2mpeg::app {

/// Sums and means over the pictures of one type.
struct CodedType {
    char type = '?';
    std::int64_t pictures = 0;
    std::int64_t bytes = 0;
    double quantiser = 0, min_quantiser = 0, max_quantiser = 0;
    double intra = 0;
    av::VectorFacts forward, backward;  ///< lengths: of all moving macroblocks; `longest` the longest of all
};

/// One row for every type that a film has, in the order I, P, B, others.
std::vector<CodedType> coded_types(const av::Inspection& film);

/// Bytes of all pictures that are shown.
std::int64_t coded_bytes(const av::Inspection& film);

/// Pictures from one group's beginning to the next one's, the most there are; and the groups' number.
struct Groups {
    std::int64_t count = 0, longest = 0;
};
Groups groups_of(const av::Inspection& film);

}  // namespace render2mpeg::app
