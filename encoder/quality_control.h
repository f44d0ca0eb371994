#pragma once
// Constant quality: quantisers from the errors that pictures came to.
#include "encoder/types.h"

namespace render2mpeg::encoder {

/// PSNR-HVS-M that a quality of 0..100 stands for, dB.
double psnr_of_quality(double quality);

/// Finds the quantisers that bring a film's PSNR-HVS-M to a quality: from the errors that its pictures came to. Knows
/// one chunk, so that chunks do not depend on one another.
class QualityControl {
  public:
    explicit QualityControl(double quality);

    /// Factor on the quantisers of the quality for the next picture.
    double factor() const;
    /// Learns the masked error of a picture (perceptual/metrics.h). `base`: its quantiser without the ratio of
    /// its type and followers.
    void learn(PictureType type, double base, double masked_error);
    /// Takes over another one's model of errors by quantiser, not its history of shown pictures.
    void expect(const QualityControl& trial);
    /// The next picture shows nothing of those before.
    void forget();

  private:
    double wanted_;        ///< masked error
    double usual_;         ///< base quantiser of the quality
    double density_ = 0;   ///< of the film: error at base quantiser 1, mean over pictures lately
    double weight_ = 0;    ///< pictures that this mean is of
    double shown_ = 0;     ///< sum of the errors shown lately
    double pictures_ = 0;  ///< and how many pictures these are
};

}  // namespace render2mpeg::encoder
