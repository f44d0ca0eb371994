#include "perceptual/share.h"

namespace render2mpeg::perceptual {

float default_share(float) {
    return 0.2f;
}

}  // namespace render2mpeg::perceptual
