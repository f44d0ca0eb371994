#pragma once

#include "perceptual/distortion.h"
#include "perceptual/masking.h"

namespace render2mpeg::perceptual {

/// MPEG-2's matrices where a film has none of its own [H262, 6.3.11], with 8 bits for intra DC.
inline const Quantisation& default_quantisation() {
    static const Quantisation quantisation = [] {
        Quantisation q;
        q.intra = masking_sensitivity();  // the model's sensitivity is the default intra matrix
        q.inter.fill(16.0f);
        return q;
    }();
    return quantisation;
}

}  // namespace render2mpeg::perceptual
