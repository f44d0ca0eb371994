#include "perceptual/share.h"

#include "core/error.h"

namespace render2mpeg::perceptual {

float default_share(float scale) {
    EXPECTS(scale > 0.0f);
    // fit: docs/fits/coupled-share. The same for every quantiser: a power of the scale saves less at the same loss.
    return 0.3f;
}

}  // namespace render2mpeg::perceptual
