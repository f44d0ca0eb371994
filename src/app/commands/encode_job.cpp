#include "app/commands/encode_job.h"

#include <algorithm>
#include <deque>

#include "app/estimate/first_pass.h"
#include "app/loop/motion.h"
#include "app/loop/picture_coder.h"
#include "app/system/interrupt.h"

namespace render2mpeg::app {
namespace {

/// Motion of one frame by files; none where none are given. Its time counts as reading.
class FileMotion : public Motion {
  public:
    FileMotion(EncodeJob& job, std::int64_t frame, RunStatistics& statistics)
        : job_(job), frame_(frame), statistics_(statistics) {}

    /// Beyond the source's reach a point is taken to rest (going on as before needs up to 1.4 % more bits).
    const core::MotionField* onward(std::int64_t horizon) override {
        const std::int64_t reached = std::min(horizon, frame_ + MotionSource::reach_onward);
        const core::MotionField* field = to(reached);
        if (field == nullptr || reached == horizon) return field;
        onward_ = *field;
        onward_.reference = horizon;
        return &onward_;
    }

  private:
    std::optional<core::MotionField> find(std::int64_t reference) override {
        if (!job_.motion) return std::nullopt;
        const StageTimer timer(statistics_, Stage::develop);
        return job_.motion->between(frame_, reference);
    }

    EncodeJob& job_;
    std::int64_t frame_;
    RunStatistics& statistics_;
    core::MotionField onward_;
};

/// A rough coding of the chunk's first pictures: those that are read ahead anyway.
std::vector<encoder::FirstPassPicture> try_first(EncodeJob& job, const Film& film, const Chunk& chunk,
                                                 FramesAhead& ahead, RunStatistics& statistics) {
    const std::deque<core::Picture>& pictures = ahead.waiting(statistics);
    if (pictures.empty()) return {};
    Film fast = film;
    fast.coding = rough(film.coding, usual_quantiser(film.coding));
    PictureCoder coder(fast, {chunk.index, chunk.first, pictures.back().number}, {}, {}, statistics, false,
                       &ahead.look());
    FirstPassCollector trial(fast.coding);
    for (const core::Picture& picture : pictures) {
        FileMotion motion(job, picture.number, statistics);
        const encoder::PicturePlan plan = coder.plan(picture.number, ahead.look().cut_before(picture.number), motion);
        trial.all(coder.code(picture, plan, motion));
    }
    trial.all(coder.flush());
    return trial.film();
}

}  // namespace

std::optional<Chunk> chunk_after(const Film& film, const std::optional<Chunk>& before) {
    // chosen: longer than any chunk is.
    const std::int64_t far = film.frames.first + 100'000;
    const Chunk first = chunks_of({film.frames.first, std::min(film.frames.last, far)}, film.coding.gop).front();
    if (!before) return first;
    if (before->last >= film.frames.last) return {};
    return Chunk{before->index + 1, before->last + 1, std::min(before->last + first.frames(), film.frames.last)};
}

bool encode_chunk(EncodeJob& job, const Film& film, const Chunk& chunk,
                  std::span<const encoder::BitAllocation> allocations, LoopObserver& observer,
                  RunStatistics& statistics, Progress& progress) {
    observer.begins(chunk);
    FramesAhead ahead(*job.frames, chunk, film.coding);
    PictureCoder coder(film, chunk, allocations, {}, statistics, false, &ahead.look());
    if (film.coding.rate_control.bit_rate > 0 && allocations.empty())
        coder.expect(try_first(job, film, chunk, ahead, statistics));

    bool whole = true;
    for (std::int64_t n = chunk.first; n <= chunk.last && whole; ++n) {
        {
            const FrameTimer timer(statistics);
            const std::optional<core::Picture> picture = ahead.next(statistics);
            if (!picture) break;  // an open-ended source has ended
            FileMotion motion(job, n, statistics);
            std::vector<const core::Picture*> pictures{&*picture};
            for (const core::Picture& later : ahead.later()) pictures.push_back(&later);
            const encoder::PicturePlan coding = coder.plan(n, ahead.look().cut_before(n), motion, pictures);
            observer.read(*picture, n > chunk.first ? motion.to(n - 1) : nullptr);
            observer.all(coder.code(*picture, coding, motion));
        }
        progress.advance();
        whole = !InterruptGuard::requested() || n == chunk.last;
    }
    observer.all(coder.flush());
    if (whole) observer.ends(chunk);
    return whole;
}

}  // namespace render2mpeg::app
