#include "encoder/encoder.h"

#include <utility>

#include "encoder/mpeg2/bit_writer.h"
#include "encoder/mpeg2/frame.h"
#include "encoder/mpeg2/levels.h"
#include "encoder/mpeg2/picture_coding.h"
#include "encoder/mpeg2/syntax.h"

namespace render2mpeg::encoder {

namespace {

/// The last picture pushed, as the next one refers to it.
struct Reference {
    std::int64_t number = 0;
    mpeg2::Frame frame;
    core::Plane<mpeg2::Vector> vectors;
};

int macroblocks(int size) {
    return (size + 15) / 16;
}

}  // namespace

struct Encoder::Impl {
    explicit Impl(const Settings& s)
        : settings(s),
          level(mpeg2::level_for(s)),
          watch(level, s.rate),
          source(macroblocks(s.width), macroblocks(s.height)) {}

    const Settings settings;
    const mpeg2::Level& level;
    mpeg2::BufferWatch watch;
    mpeg2::Frame source;  ///< the picture being coded; kept for its memory

    // What plan() has decided so far; it may run ahead of push().
    std::optional<std::int64_t> last_planned;
    std::int64_t planned_gop_start = 0;

    // Where push() stands.
    std::optional<Reference> reference;
    std::int64_t gop_start = 0;
    std::int64_t coding_order = 0;

    void check(const core::Picture& picture, const PicturePlan& plan, std::span<const core::MotionField> motion) const;
    void write_headers(mpeg2::BitWriter& out, const PicturePlan& plan) const;
};

void Encoder::Impl::check(const core::Picture& picture, const PicturePlan& plan,
                          std::span<const core::MotionField> motion) const {
    const int chroma_width = (settings.width + 1) / 2, chroma_height = (settings.height + 1) / 2;
    EXPECTS(picture.width() == settings.width && picture.height() == settings.height);
    EXPECTS(picture.cb.width() == chroma_width && picture.cb.height() == chroma_height);
    EXPECTS(picture.cr.width() == chroma_width && picture.cr.height() == chroma_height);
    EXPECTS(picture.number == plan.number && plan.number >= 0);
    EXPECTS(plan.quantiser >= 1 && plan.quantiser <= 31);
    EXPECTS(plan.type == PictureType::intra || plan.type == PictureType::predicted);
    EXPECTS(plan.starts_gop ? plan.type == PictureType::intra : plan.number > gop_start);
    EXPECTS(plan.references.size() == (plan.type == PictureType::predicted ? 1u : 0u));
    EXPECTS(motion.empty() || motion.size() == plan.references.size());
    if (plan.type == PictureType::predicted) EXPECTS(reference && reference->number == plan.references[0]);
    for (const core::MotionField& field : motion) {
        EXPECTS(field.picture == plan.number && field.reference == plan.references[0]);
        EXPECTS(field.vector.width() == settings.width && field.vector.height() == settings.height);
        EXPECTS(field.kind.width() == settings.width && field.kind.height() == settings.height);
    }
}

void Encoder::Impl::write_headers(mpeg2::BitWriter& out, const PicturePlan& plan) const {
    if (!plan.starts_gop) return;
    mpeg2::write_sequence(out, settings, level);
    mpeg2::write_gop(out, settings.rate, plan.number);
}

Encoder::Encoder(const Settings& settings) : impl_(std::make_unique<Impl>(settings)) {}
Encoder::~Encoder() = default;

PicturePlan Encoder::plan(std::int64_t number, const PictureFacts& facts, bool first_of_chunk) {
    Impl& m = *impl_;
    EXPECTS(number >= 0 && (!m.last_planned || first_of_chunk || number == *m.last_planned + 1));
    PicturePlan plan;
    plan.number = number;
    plan.quantiser = m.settings.quantiser;
    plan.starts_gop =
        !m.last_planned || first_of_chunk || facts.cut_before || number - m.planned_gop_start >= m.settings.gop;
    plan.type = plan.starts_gop ? PictureType::intra : PictureType::predicted;
    if (plan.starts_gop) {
        m.planned_gop_start = number;
    } else {
        plan.references = {number - 1};
    }
    m.last_planned = number;
    return plan;
}

std::vector<CodedPicture> Encoder::push(const core::Picture& picture, const PicturePlan& plan,
                                        std::span<const core::MotionField> motion) {
    Impl& m = *impl_;
    m.check(picture, plan, motion);
    if (plan.starts_gop) m.gop_start = plan.number;
    mpeg2::pad(picture, m.source);

    // Code against the last picture and its vectors.
    const bool predicted = plan.type == PictureType::predicted;
    const bool vectors_known = predicted && !m.reference->vectors.empty();
    mpeg2::PictureResult result =
        mpeg2::code_picture({m.source, predicted ? &m.reference->frame : nullptr, motion.empty() ? nullptr : &motion[0],
                             vectors_known ? &m.reference->vectors : nullptr, m.settings.height,
                             static_cast<int>(plan.number - m.gop_start), plan.quantiser},
                            m.level);

    CodedPicture coded;
    coded.plan = plan;
    coded.coding_order = m.coding_order++;
    mpeg2::BitWriter headers;
    m.write_headers(headers, plan);
    coded.bytes = headers.take();
    coded.bytes.insert(coded.bytes.end(), result.bytes.begin(), result.bytes.end());
    coded.exceeds_level = !m.watch.remove(coded.bytes.size() * 8);
    coded.reconstruction = mpeg2::crop(result.reconstruction, m.settings.width, m.settings.height, plan.number);
    coded.macroblocks = std::move(result.records);
    coded.block_evaluations = result.evaluations;
    m.reference = Reference{plan.number, std::move(result.reconstruction), std::move(result.vectors)};

    std::vector<CodedPicture> complete;
    complete.push_back(std::move(coded));
    return complete;
}

std::vector<CodedPicture> Encoder::flush() {
    return {};
}

}  // namespace render2mpeg::encoder
