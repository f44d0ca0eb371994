#pragma once
// Follows the VBV buffer from picture to picture, with stuffing and vbv_delay.
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <vector>

#include "encoder/mpeg2/picture/minimal_picture.h"
#include "encoder/mpeg2/rate/vbv_buffer.h"
#include "encoder/types.h"

/// How many bits the next picture may have, so that all that follow fit the VBV.
namespace render2mpeg::encoder::mpeg2 {

/// State of the VBV buffer around the removal of a picture.
struct Removal {
    /// Bits; after: with the stuffing taken out too; next: when the next picture's turn comes.
    std::int64_t fullness_before = 0, fullness_after = 0, fullness_next = 0;
    std::int64_t stuffing_bytes = 0;
    int delay = 0xffff;  ///< vbv_delay for the picture's header; 0xffff: variable rate
};

/// The buffer together with what is known of the pictures to come: how many bits the next one may have, so that all
/// that follow find at least room for a minimal picture, and the next chunk finds the fullness it was promised.
///
/// It serves one session: a chunk of known length, or pictures that follow one another without one.
///
/// Everything is told by places in coding order, which are counted as display numbers: the I picture of a GOP that
/// begins with B pictures stands at the first of these.
class VbvSchedule {
  public:
    VbvSchedule(const Settings& settings, const Channel& channel, const MinimalBits& minimal);

    /// Whether the picture after those planned can begin a GOP: intra pictures cost more than others even if they show
    /// nothing.
    bool affords_gop(std::int64_t number) const;
    /// Notes a planned picture. `intra`: an I picture stands at its place. `left_in_chunk` as in PictureFacts.
    void plan(std::int64_t number, bool intra, bool first_of_chunk, std::optional<std::int64_t> left_in_chunk,
              bool last_chunk);
    /// Whether everything planned and foreseen fits, each picture minimal.
    bool feasible() const { return feasible(gop_starts_, next_, buffer_.fullness()); }

    /// Bits that the next picture to be coded may have, whole access unit.
    std::int64_t most_bits() const;
    /// Bits in the buffer before the next picture is taken out.
    std::int64_t fullness() const { return buffer_.whole_bits(buffer_.fullness()); }
    /// Takes the next picture out; `bits` of it come up to its picture_start_code, this included.
    Removal take(std::int64_t bits, std::int64_t bits_to_start_code);

    /// Display number that stands where the next picture to be coded stands.
    std::int64_t next() const { return next_; }

  private:
    using Numbers = std::set<std::int64_t>;

    /// Fractions that must be in the buffer before picture `from` is taken out, or nothing where that is more than it
    /// holds. GOPs begin at `starts` and from the last of them on the regular grid.
    std::optional<std::int64_t> need(const Numbers& starts, std::int64_t from) const;
    bool feasible(const Numbers& starts, std::int64_t from, std::int64_t fullness) const;
    /// End of the look-ahead, and the buffer fullness required there.
    struct Horizon {
        std::int64_t number, fractions;
    };
    Horizon horizon(const Numbers& starts) const;
    /// Fractions that a picture takes at least.
    std::int64_t least(const Numbers& starts, std::int64_t number) const;
    /// Fractions needed before `from`, where `need` are needed before `end`; `unbearable` where the buffer holds less.
    std::int64_t back(const Numbers& starts, std::int64_t end, std::int64_t from, std::int64_t need) const;
    static constexpr std::int64_t unbearable = std::numeric_limits<std::int64_t>::max();
    int fields(std::int64_t number) const { return fields_after(settings_, number - settings_.first_number); }

    Settings settings_;
    bool constant_;
    MinimalBits minimal_;
    VbvBuffer buffer_;
    Numbers gop_starts_;                     ///< places of I pictures, from the one before next_ on
    std::optional<std::int64_t> chunk_end_;  ///< first number after the chunk planned last, if it is known
    bool hands_over_ = false;                ///< and something follows
    std::int64_t next_ = 0;
    std::int64_t planned_end_ = 0;  ///< first number not planned
    bool started_ = false;
};

/// Throws core::Error where rate and buffer cannot carry an endless film even of minimal pictures.
void check_channel(const Settings& settings, const Level& level);

}  // namespace render2mpeg::encoder::mpeg2
