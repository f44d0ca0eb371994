#include "parallel/loop_record.h"

#include <algorithm>
#include <array>
#include <ctime>
#include <fstream>
#include <map>
#include <memory>
#include <queue>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "parallel/loops.h"

namespace render2mpeg::parallel {
namespace {

/// CPU seconds of this thread.
double thread_seconds() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Loops of one place.
struct Loops {
    std::size_t loops = 0, tasks = 0;
    double seconds = 0, longest = 0, before = 0;
    std::array<double, std::size(recorded_threads)> by_threads{};
};

struct Record {
    std::filesystem::path file;
    std::map<std::pair<std::string, int>, Loops> places;
    double last = thread_seconds();  ///< when the loop before ended, or the record began
};

/// Of the thread that began it.
thread_local std::unique_ptr<Record> record_of_thread;
thread_local bool in_loop = false;

/// Seconds that tasks take if each is begun, in their order, by the first thread that is free.
double scheduled(const std::vector<double>& tasks, int threads) {
    std::priority_queue<double, std::vector<double>, std::greater<>> free;
    for (int i = 0; i < threads; ++i) free.push(0.0);
    double end = 0;
    for (const double seconds : tasks) {
        const double done = free.top() + seconds;
        free.pop();
        free.push(done);
        end = std::max(end, done);
    }
    return end;
}

}  // namespace

LoopRecord::LoopRecord(std::filesystem::path file) {
    EXPECTS(record_of_thread == nullptr);
    record_of_thread = std::make_unique<Record>();
    record_of_thread->file = std::move(file);
}

LoopRecord::~LoopRecord() {
    const std::unique_ptr<Record> record = std::move(record_of_thread);
    std::ofstream out(record->file);
    for (const auto& [place, l] : record->places) {
        out << place.first << ' ' << place.second << ' ' << l.loops << ' ' << l.tasks << ' ' << l.seconds << ' '
            << l.longest << ' ' << l.before;
        for (const double seconds : l.by_threads) out << ' ' << seconds;
        out << '\n';
    }
    out << thread_seconds() - record->last << '\n';
}

bool is_recorded() {
    return record_of_thread != nullptr && !in_loop;
}

void record(std::size_t count, const char* file, int line,
            const std::function<void(const std::function<void(std::size_t)>&)>& run,
            const std::function<void(std::size_t)>& body) {
    Loops& loops = record_of_thread->places[{file, line}];
    loops.before += thread_seconds() - record_of_thread->last;
    std::vector<double> tasks(count, 0.0);
    in_loop = true;
    try {
        run([&](std::size_t i) {
            const double begin = thread_seconds();
            body(i);
            tasks[i] = thread_seconds() - begin;
        });
    } catch (...) {
        in_loop = false;
        throw;
    }
    in_loop = false;
    loops.loops += 1;
    loops.tasks += count;
    for (const double seconds : tasks) loops.seconds += seconds;
    if (count > 0) loops.longest += *std::max_element(tasks.begin(), tasks.end());
    for (std::size_t k = 0; k < loops.by_threads.size(); ++k)
        loops.by_threads[k] += scheduled(tasks, recorded_threads[k]);
    record_of_thread->last = thread_seconds();
}

}  // namespace render2mpeg::parallel
