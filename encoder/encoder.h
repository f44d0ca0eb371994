#pragma once
// The MPEG-2 encoder: plans and codes one picture after the other into a stream.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/motion_field.h"
#include "core/picture.h"
#include "encoder/coder.h"
#include "encoder/types.h"

/// The encoder: pictures in display order become coded pictures in coding order.
namespace render2mpeg::encoder {

/// Throws core::Error, naming the limit, where no level of Main Profile allows size and rates, or where even pictures
/// without any detail would not fit the rate.
void check(const Settings& settings);

/// Nothing where another codec has no such limits. Throws as check() does.
Declaration declaration_of(const Settings& settings);

/// Our MPEG-2 coder. Exact motion comes first; it searches where that is not good enough. Of pictures promised to
/// plan() none is held back at their end. check() made sure that chunks of whole GOPs fit their rate.
class Encoder final : public Coder {
  public:
    /// Throws as check() does.
    explicit Encoder(const Settings& settings);
    ~Encoder() override;

    PicturePlan plan(std::int64_t number, const PictureFacts& facts, bool first_of_chunk) override;
    using Coder::push;
    std::vector<CodedPicture> push(const core::Picture& picture, const PicturePlan& plan,
                                   std::span<const core::MotionField> motion, const Hints& hints) override;
    std::vector<CodedPicture> flush() override;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// sequence_end_code: ends the last picture of a film; without it libmpeg2 drops pictures.
std::vector<std::uint8_t> sequence_end();

}  // namespace render2mpeg::encoder
