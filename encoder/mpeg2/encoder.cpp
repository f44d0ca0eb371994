#include "encoder/encoder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "encoder/cadence.h"
#include "encoder/mpeg2/bit_writer.h"
#include "encoder/mpeg2/candidates.h"
#include "encoder/mpeg2/dependency.h"
#include "encoder/mpeg2/frame.h"
#include "encoder/mpeg2/levels.h"
#include "encoder/mpeg2/picture_coding.h"
#include "encoder/mpeg2/syntax.h"
#include "encoder/mpeg2/tuning.h"

namespace render2mpeg::encoder {

namespace {

/// A coded I or P picture, as others refer to it.
struct Reference {
    std::int64_t number = 0;
    std::int64_t refers_to = 0;  ///< where `vectors` lead
    mpeg2::Frame frame;
    core::Plane<mpeg2::Vector> vectors;  ///< empty: none
};

/// A B picture that waits for the later one that it refers to.
struct Waiting {
    PicturePlan plan;
    mpeg2::Frame source;
    std::vector<core::Plane<mpeg2::Candidates>> exact;  ///< per reference of the plan, or empty
};

int macroblocks(int size) {
    return (size + 15) / 16;
}

/// Fields are whole macroblocks too [H262, 6.3.3: mb_height].
int macroblock_rows(const Settings& s) {
    return s.cadence == Cadence::frames ? macroblocks(s.height) : 2 * ((s.height + 31) / 32);
}

int quantiser_of(PictureType type, int quantiser) {
    if (type != PictureType::bidirectional) return quantiser;
    return std::min(31, static_cast<int>(std::lround(mpeg2::quantiser_ratio_bidirectional * quantiser)));
}

/// The reference's vectors as a guess for motion over other distances in time: half pixels times `distance`, per
/// picture of theirs.
core::Plane<mpeg2::Vector> stretched(const Reference& from, std::int64_t distance) {
    const std::int64_t theirs = from.refers_to - from.number;
    core::Plane<mpeg2::Vector> vectors = from.vectors;
    if (distance == theirs) return vectors;
    for (mpeg2::Vector& v : vectors.values()) {
        const auto stretch = [&](int component) {
            return static_cast<std::int16_t>(std::clamp<std::int64_t>(component * distance / theirs, -4096, 4095));
        };
        v = {stretch(v.x), stretch(v.y)};
    }
    return vectors;
}

}  // namespace

struct Encoder::Impl {
    explicit Impl(const Settings& s)
        : settings(s),
          level(mpeg2::level_for(s)),
          watch(level, s.rate),
          source(macroblocks(s.width), macroblock_rows(s)) {}

    const Settings settings;
    const mpeg2::Level& level;
    mpeg2::BufferWatch watch;
    mpeg2::Frame source;  ///< the picture being coded; kept for its memory

    // What plan() has decided so far; it may run ahead of push().
    std::optional<std::int64_t> last_planned;
    std::int64_t planned_gop_start = 0;
    std::int64_t planned_earlier = 0, planned_later = 0;  ///< I or P pictures around the one planned last, or itself

    // Where push() stands.
    std::optional<Reference> earlier, later;  ///< the newest two I and P pictures
    std::vector<Waiting> waiting;             ///< for the one after `later`
    std::int64_t gop_start = 0;
    std::int64_t coding_order = 0;

    void check(const core::Picture& picture, const PicturePlan& plan, std::span<const core::MotionField> motion,
               const Hints& hints) const;
    void write_headers(mpeg2::BitWriter& out, const PicturePlan& plan) const;
    CodedPicture code(const mpeg2::Frame& picture, const PicturePlan& plan,
                      std::span<const core::Plane<mpeg2::Candidates>> exact,
                      const core::Plane<float>& quantiser_factors = {});
    void code_waiting(std::vector<CodedPicture>& complete);
};

void Encoder::Impl::check(const core::Picture& picture, const PicturePlan& plan,
                          std::span<const core::MotionField> motion, const Hints& hints) const {
    const int chroma_width = (settings.width + 1) / 2, chroma_height = (settings.height + 1) / 2;
    EXPECTS(picture.width() == settings.width && picture.height() == settings.height);
    EXPECTS(picture.cb.width() == chroma_width && picture.cb.height() == chroma_height);
    EXPECTS(picture.cr.width() == chroma_width && picture.cr.height() == chroma_height);
    EXPECTS(picture.number == plan.number && plan.number >= 0);
    EXPECTS(plan.quantiser >= 1 && plan.quantiser <= 31);

    // References are the last I or P picture, and for B pictures the one that will come next.
    EXPECTS(plan.starts_gop == (plan.type == PictureType::intra));
    EXPECTS(plan.references.size() == static_cast<std::size_t>(plan.type) - 1);
    EXPECTS(plan.starts_gop ? waiting.empty() : plan.number > gop_start);
    if (!plan.starts_gop) EXPECTS(later && later->number == plan.references[0] && plan.number > later->number);
    const bool bidirectional = plan.type == PictureType::bidirectional;
    if (bidirectional) EXPECTS(plan.number < plan.references[1]);
    for (const Waiting& w : waiting)
        EXPECTS(w.plan.number < plan.number &&
                w.plan.references[1] == (bidirectional ? plan.references[1] : plan.number));

    EXPECTS(motion.empty() || motion.size() == plan.references.size());
    for (std::size_t i = 0; i < motion.size(); ++i) {
        const core::MotionField& field = motion[i];
        EXPECTS(field.picture == plan.number && field.reference == plan.references[i]);
        EXPECTS(field.vector.width() == settings.width && field.vector.height() == settings.height);
        EXPECTS(field.kind.width() == settings.width && field.kind.height() == settings.height);
    }
    if (!hints.onward) return;
    EXPECTS(plan.horizon && hints.onward->picture == plan.number && hints.onward->reference == *plan.horizon);
    EXPECTS(hints.onward->vector.width() == settings.width && hints.onward->vector.height() == settings.height);
    EXPECTS(hints.onward->kind.width() == settings.width && hints.onward->kind.height() == settings.height);
}

void Encoder::Impl::write_headers(mpeg2::BitWriter& out, const PicturePlan& plan) const {
    if (!plan.starts_gop) return;
    mpeg2::write_sequence(out, settings, level);
    mpeg2::write_gop(out, settings, plan.number);
}

/// Codes a picture whose references are there; an I or P picture becomes the newest one.
CodedPicture Encoder::Impl::code(const mpeg2::Frame& picture, const PicturePlan& plan,
                                 std::span<const core::Plane<mpeg2::Candidates>> exact,
                                 const core::Plane<float>& quantiser_factors) {
    mpeg2::PictureTask task{picture,
                            plan.type,
                            {},
                            {},
                            {},
                            settings.height,
                            static_cast<int>(plan.number - gop_start),
                            plan.quantiser,
                            settings.effort,
                            fields_of(settings, plan.number)};
    if (!quantiser_factors.empty()) task.quantiser_factors = &quantiser_factors;
    core::Plane<mpeg2::Vector> predictors[2];
    const bool bidirectional = plan.type == PictureType::bidirectional;
    for (std::size_t i = 0; i < plan.references.size(); ++i) {
        task.reference[i] = bidirectional && i == 0 ? &earlier->frame : &later->frame;
        if (i < exact.size()) task.exact[i] = &exact[i];
        if (later->vectors.empty()) continue;
        predictors[i] = stretched(*later, plan.references[i] - plan.number);
        task.predictors[i] = &predictors[i];
    }
    mpeg2::PictureResult result = mpeg2::code_picture(task, level);

    CodedPicture coded;
    coded.plan = plan;
    coded.quantiser = plan.quantiser;
    coded.coding_order = coding_order++;
    mpeg2::BitWriter headers;
    write_headers(headers, plan);
    coded.bytes = headers.take();
    coded.bytes.insert(coded.bytes.end(), result.bytes.begin(), result.bytes.end());
    coded.exceeds_level = !watch.remove(coded.bytes.size() * 8);
    coded.reconstruction = mpeg2::crop(result.reconstruction, settings.width, settings.height, plan.number);
    coded.macroblocks = std::move(result.records);
    coded.block_evaluations = result.evaluations;
    if (bidirectional) return coded;
    earlier = std::move(later);
    later = Reference{plan.number, plan.references.empty() ? plan.number : plan.references[0],
                      std::move(result.reconstruction), std::move(result.vectors)};
    return coded;
}

/// Codes the B pictures between the newest two others.
void Encoder::Impl::code_waiting(std::vector<CodedPicture>& complete) {
    for (const Waiting& w : waiting) complete.push_back(code(w.source, w.plan, w.exact));
    waiting.clear();
}

Encoder::Encoder(const Settings& settings) : impl_(std::make_unique<Impl>(settings)) {}
Encoder::~Encoder() = default;

PicturePlan Encoder::plan(std::int64_t number, const PictureFacts& facts, bool first_of_chunk) {
    Impl& m = *impl_;
    EXPECTS(number >= 0 && (!m.last_planned || first_of_chunk || number == *m.last_planned + 1));
    PicturePlan plan;
    plan.number = number;
    plan.starts_gop = !m.last_planned || first_of_chunk || facts.cut_before || facts.keyframe ||
                      number - m.planned_gop_start >= m.settings.gop;
    if (plan.starts_gop) {
        // B pictures may have been promised this picture as their later reference, in their own GOP.
        EXPECTS(!m.last_planned || m.planned_later <= *m.last_planned);
        plan.type = PictureType::intra;
        m.planned_gop_start = m.planned_earlier = m.planned_later = number;
    } else {
        if (number > m.planned_later) {
            const std::int64_t left = std::min(facts.frames_left, m.planned_gop_start + m.settings.gop - 1 - number);
            m.planned_earlier = m.planned_later;
            m.planned_later = number + std::clamp<std::int64_t>(left, 0, m.settings.b_pictures);
        }
        plan.type = number < m.planned_later ? PictureType::bidirectional : PictureType::predicted;
        plan.references = {m.planned_earlier};
        if (plan.type == PictureType::bidirectional) plan.references.push_back(m.planned_later);
    }
    const std::int64_t horizon = std::min(number + facts.frames_left, m.planned_gop_start + m.settings.gop - 1);
    if (plan.type != PictureType::bidirectional && horizon > number) plan.horizon = horizon;
    plan.quantiser = quantiser_of(plan.type, m.settings.quantiser);
    m.last_planned = number;
    return plan;
}

std::vector<CodedPicture> Encoder::push(const core::Picture& picture, const PicturePlan& plan,
                                        std::span<const core::MotionField> motion, const Hints& hints) {
    Impl& m = *impl_;
    m.check(picture, plan, motion, hints);
    if (plan.starts_gop) m.gop_start = plan.number;
    std::vector<core::Plane<mpeg2::Candidates>> exact;
    for (const core::MotionField& field : motion)
        exact.push_back(mpeg2::exact_candidates(field, m.source.columns(), m.source.rows(), m.level.horizontal_f_code));

    std::vector<CodedPicture> complete;
    if (plan.type == PictureType::bidirectional) {
        Waiting& waiting =
            m.waiting.emplace_back(Waiting{plan, mpeg2::Frame(m.source.columns(), m.source.rows()), std::move(exact)});
        mpeg2::pad(picture, waiting.source);
        return complete;
    }
    mpeg2::pad(picture, m.source);
    const core::Plane<float> factors =
        hints.onward ? mpeg2::quantiser_factors(*hints.onward, m.source.columns(), m.source.rows())
                     : core::Plane<float>();
    complete.push_back(m.code(m.source, plan, exact, factors));
    m.code_waiting(complete);
    return complete;
}

std::vector<CodedPicture> Encoder::flush() {
    Impl& m = *impl_;
    std::vector<CodedPicture> complete;
    if (m.last_planned) m.planned_later = *m.last_planned;
    if (m.waiting.empty()) return complete;

    // What they wait for will not come: the last one takes its place, and of the others' motion the forward part holds.
    Waiting last = std::move(m.waiting.back());
    m.waiting.pop_back();
    last.plan.type = PictureType::predicted;
    last.plan.references.pop_back();
    last.plan.quantiser = quantiser_of(PictureType::predicted, m.settings.quantiser);
    for (Waiting& w : m.waiting) w.plan.references[1] = last.plan.number;
    for (Waiting& w : m.waiting) w.exact.resize(std::min<std::size_t>(w.exact.size(), 1));
    last.exact.resize(std::min<std::size_t>(last.exact.size(), 1));
    complete.push_back(m.code(last.source, last.plan, last.exact));
    m.code_waiting(complete);
    return complete;
}

}  // namespace render2mpeg::encoder
