#include "app/system/image_reader.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <deque>
#include <iostream>
#include <new>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>

#include "app/system/interrupt.h"
#include "core/error.h"
#include "core/plain_file.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

/// chosen: the largest image takes 48 bytes a pixel (docs/measurements.md#memory) and some ten seconds.
constexpr scene::ProbeLimits image_limits{(std::uintmax_t{1} << 30) + 48 * std::uintmax_t{image::max_pixels}, 60, 600};

using nlohmann::json;

/// What a probe says of one image, on a page of the file that is its standard input, behind the question. Pixels, or
/// the words of a refusal, begin on the next page.
struct Answer {
    image::ImageHeader header;
    bool is_refused = false, has_alpha = false, high_range = false, in_codes = false;
    float pixel_aspect = 1;
    std::uint64_t bytes = 0;  ///< on the next pages

    std::uint64_t bytes_of_pixels() const {
        const auto pixels = static_cast<std::uint64_t>(header.width) * static_cast<std::uint64_t>(header.height);
        return pixels * (in_codes ? sizeof(image::Codes) : sizeof(glm::vec4));
    }
};

constexpr std::uint64_t page = 4096;

std::uint64_t whole_pages(std::uint64_t bytes) {
    return (bytes + page - 1) / page * page;
}

std::uint64_t size_of_file(int file) {
    struct stat state {};
    return fstat(file, &state) == 0 ? static_cast<std::uint64_t>(state.st_size) : 0;
}

/// Encoded bytes; 0 where there is no such file.
std::uintmax_t size_of(const scene::ImageSource& source) {
    std::error_code failure;
    const std::uintmax_t size = source.path.empty() ? 0 : std::filesystem::file_size(source.path, failure);
    return failure ? 0 : std::max<std::uintmax_t>(size, source.bytes.size());
}

void write_at(int file, std::uint64_t at, std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t n = pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(at));
        if (n < 0 && errno != EINTR) throw std::bad_alloc();
        if (n <= 0) continue;
        at += static_cast<std::uint64_t>(n);
        bytes = bytes.subspan(static_cast<std::size_t>(n));
    }
}

/// A part of a file in memory, which is given back to the system in the end.
class SharedPart {
  public:
    /// `file` stays open.
    SharedPart(std::shared_ptr<const int> file, std::uint64_t first, std::uint64_t bytes)
        : file_(std::move(file)), first_(first), bytes_(bytes) {
        void* const at = mmap(nullptr, bytes, PROT_READ, MAP_SHARED, *file_, static_cast<off_t>(first));
        if (at == MAP_FAILED) throw std::bad_alloc();
        start_ = static_cast<const std::byte*>(at);
    }
    ~SharedPart() {
        munmap(const_cast<std::byte*>(start_), bytes_);
        fallocate(*file_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(first_),
                  static_cast<off_t>(bytes_));
    }
    SharedPart(const SharedPart&) = delete;
    SharedPart& operator=(const SharedPart&) = delete;
    const std::byte* start() const { return start_; }

  private:
    std::shared_ptr<const int> file_;
    std::uint64_t first_, bytes_;
    const std::byte* start_ = nullptr;
};

image::StoredImage image_of(const Answer& answer, const std::shared_ptr<const int>& file, std::uint64_t first) {
    const auto part = std::make_shared<const SharedPart>(file, first, answer.bytes);
    image::StoredImage image;
    image.width = answer.header.width;
    image.height = answer.header.height;
    image.has_alpha = answer.has_alpha;
    image.high_range = answer.high_range;
    image.pixel_aspect = answer.pixel_aspect;
    if (answer.in_codes)
        image.codes = {reinterpret_cast<const image::Codes*>(part->start()), image.pixels()};
    else
        image.values = {reinterpret_cast<const glm::vec4*>(part->start()), image.pixels()};
    image.memory = part;
    return image;
}

std::vector<std::uint8_t> packed(const scene::Animation& film, const std::vector<int>& images) {
    json list = json::array();
    for (const int i : images) {
        const scene::ImageSource& source = film.images[static_cast<std::size_t>(i)];
        const auto* bytes = reinterpret_cast<const std::uint8_t*>(source.bytes.data());
        list.push_back({source.path.native(), source.name, json::binary({bytes, bytes + source.bytes.size()})});
    }
    return json::to_msgpack(list);
}

/// Answers about one image of `question`, at `at`; returns where the next answer begins.
std::uint64_t answer(const json& question, bool header_alone, std::uint64_t at) {
    const auto path = question.at(0).get<std::string>(), name = question.at(1).get<std::string>();
    const std::vector<std::uint8_t>& binary = question.at(2).get_binary();
    const std::span<const std::byte> encoded = std::as_bytes(std::span(binary));
    Answer says;
    std::string refusal;
    image::StoredImage image;
    try {
        if (header_alone) {
            says.header = image::read_image_header(path, encoded, name);
        } else {
            image = image::read_stored_image(path, encoded, name);
            says = {{image.width, image.height, !image.codes.empty()},
                    false,
                    image.has_alpha,
                    image.high_range,
                    !image.codes.empty(),
                    image.pixel_aspect};
        }
    } catch (const core::Error& error) {
        if (errno == ENOMEM) throw;
        says.is_refused = true;
        refusal = error.what();
    }
    const std::span<const std::byte> more = says.is_refused ? std::as_bytes(std::span(refusal))
                                            : says.in_codes ? std::as_bytes(image.codes)
                                                            : std::as_bytes(image.values);
    says.bytes = more.size();
    write_at(STDIN_FILENO, at, std::as_bytes(std::span(&says, 1)));
    write_at(STDIN_FILENO, at + page, more);
    return at + page + whole_pages(says.bytes);
}

}  // namespace

/// Images of one probe.
struct ImageReader::Group {
    Group(const scene::Animation& film, std::vector<int> numbers, std::uintmax_t memory, bool headers)
        : images(std::move(numbers)),
          headers_alone(headers),
          limits{memory, image_limits.seconds, image_limits.clock_seconds},
          question(packed(film, images)),
          probe(limits, {"images", headers ? "headers" : "pixels"}, std::as_bytes(std::span(question))) {}

    std::vector<int> images;
    bool headers_alone;
    scene::ProbeLimits limits;
    std::vector<std::uint8_t> question;
    scene::Probe probe;
};

std::set<int> images_of(const scene::Animation& film) {
    std::set<int> images;
    for (const scene::Object& object : film.objects) {
        const scene::Material& m = film.materials[static_cast<std::size_t>(object.material)];
        for (const auto& [use, name] : scene::texture_uses)
            if ((m.*use).present()) images.insert((m.*use).image);
    }
    if (film.sky.image >= 0) images.insert(film.sky.image);
    return images;
}

ImageProbes image_probes(bool held_to_limit) {
    if (held_to_limit) return {1, image_limits.memory, image_limits.memory};
    const std::size_t threads = static_cast<std::size_t>(std::max(1, parallel::thread_count()));
    const auto machine =
        static_cast<std::uintmax_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uintmax_t>(sysconf(_SC_PAGESIZE));
    // chosen: half of the machine for all of them, the other for what runs beside (1/4..1).
    const std::uintmax_t alone = std::min(image_limits.memory, machine);
    return {threads, std::min(alone, machine / 2 / threads), alone};
}

/// Keeps the first `count` answers of a probe that has ended.
void ImageReader::take_answers(Group& group, std::size_t count) {
    const std::shared_ptr<const int> file(new int(group.probe.take_input()), [](const int* open) {
        close(*open);
        delete open;
    });
    const std::uint64_t end = size_of_file(*file);
    std::uint64_t at = whole_pages(group.question.size());
    for (std::size_t i = 0; i < count; ++i) {
        Answer says;
        const std::string& name = film_->images[static_cast<std::size_t>(group.images[i])].name;
        const bool whole =
            pread(*file, &says, sizeof says, static_cast<off_t>(at)) == static_cast<ssize_t>(sizeof says) &&
            says.bytes <= end && at + page + says.bytes <= std::max(end, at + page) &&
            (says.is_refused || group.headers_alone || (says.bytes == says.bytes_of_pixels() && says.bytes > 0));
        if (!whole) throw core::Error("reading", name, "the process that read it gave no whole answer");
        Read read;
        if (says.is_refused) {
            read.refusal.resize(says.bytes);
            if (pread(*file, read.refusal.data(), says.bytes, static_cast<off_t>(at + page)) < 0) read.refusal.clear();
        } else if (!group.headers_alone) {
            read.image = image_of(says, file, at + page);
        }
        const std::lock_guard lock(mutex_);
        headers_[group.images[i]] = says.header;
        if (!group.headers_alone) held_[group.images[i]] = std::move(read);
        at += page + whole_pages(says.bytes);
    }
}

/// Waits for a probe, and starts others for its remaining images. Returns images that are short of memory; where it
/// `refuses`, these are errors.
std::vector<int> ImageReader::finish(std::unique_ptr<Group> group, bool refuses) {
    std::vector<int> large;
    while (group) {
        scene::ProbeEnd end = group->probe.end(InterruptGuard::requested);
        // A point for each image, then the error.
        const std::size_t done = std::min(end.text.find_first_not_of('.'), end.text.size());
        take_answers(*group, std::min(done, group->images.size()));
        if (end.how == scene::ProbeEnd::How::given_up || done >= group->images.size()) break;
        const int last = group->images[done];
        end.text.erase(0, done);
        try {
            scene::text_of(std::move(end), film_->images[static_cast<std::size_t>(last)].name, group->limits);
        } catch (const scene::OutOfMemory&) {
            if (refuses) throw;
            large.push_back(last);
        }
        const std::vector<int> rest(group->images.begin() + static_cast<std::ptrdiff_t>(done) + 1, group->images.end());
        group =
            rest.empty() ? nullptr : std::make_unique<Group>(*film_, rest, group->limits.memory, group->headers_alone);
    }
    return large;
}

bool ImageReader::read(const std::vector<int>& images, const ImageProbes& probes, bool headers_alone) {
    // chosen: opening OpenImageIO takes a process 0.2 s, as long as some sixteen small images or 4 MB of large ones (4
    // to 16, 1 to 16 MB).
    constexpr std::uintmax_t images_of_one = 16, bytes_of_one = 4'000'000;
    std::uintmax_t bytes = 0;
    for (const int image : images) bytes += size_of(film_->images[static_cast<std::size_t>(image)]);
    const std::uintmax_t wanted = std::max((images.size() + images_of_one - 1) / images_of_one, bytes / bytes_of_one);
    const std::size_t count = std::min({probes.at_once, images.size(), static_cast<std::size_t>(wanted)});
    std::deque<std::unique_ptr<Group>> running;
    for (std::size_t p = 0; p < count; ++p) {
        std::vector<int> own;
        for (std::size_t i = p; i < images.size(); i += count) own.push_back(images[i]);
        running.push_back(std::make_unique<Group>(*film_, std::move(own), probes.share, headers_alone));
    }
    std::vector<int> large;
    for (; !running.empty(); running.pop_front())
        for (const int image : finish(std::move(running.front()), probes.share >= probes.alone)) large.push_back(image);
    for (const int image : large)
        finish(std::make_unique<Group>(*film_, std::vector{image}, probes.alone, headers_alone), true);
    return !InterruptGuard::requested();
}

bool ImageReader::read_ahead(const ImageProbes& probes) {
    if (!scene::Probe::is_possible()) return !InterruptGuard::requested();
    const std::set<int> images = images_of(*film_);
    return read({images.begin(), images.end()}, probes, false);
}

std::map<int, image::ImageHeader> ImageReader::headers() {
    std::vector<int> unknown;
    for (const int i : images_of(*film_))
        if (!headers_.contains(i)) unknown.push_back(i);
    if (scene::Probe::is_possible()) {
        read(unknown, image_probes(true), true);
    } else {
        for (const int i : unknown) {
            const scene::ImageSource& source = film_->images[static_cast<std::size_t>(i)];
            headers_[i] = image::read_image_header(source.path, source.bytes, source.name);
        }
    }
    return headers_;
}

image::StoredImage ImageReader::read_here(int image) const {
    const scene::ImageSource& source = film_->images[static_cast<std::size_t>(image)];
    return image::read_stored_image(source.path, source.bytes, source.name);
}

image::StoredImage ImageReader::take(int image) {
    if (!scene::Probe::is_possible()) return read_here(image);
    const auto held = [&] {
        const std::lock_guard lock(mutex_);
        return held_.extract(image);
    };
    auto found = held();
    if (found.empty()) {
        finish(std::make_unique<Group>(*film_, std::vector{image}, image_limits.memory, false), true);
        found = held();
    }
    const std::string& name = film_->images[static_cast<std::size_t>(image)].name;
    if (found.empty()) throw core::Error("reading", name, "interrupted");
    if (!found.mapped().refusal.empty()) throw core::Error(found.mapped().refusal);
    return std::move(found.mapped().image);
}

void ImageReader::forget() {
    const std::lock_guard lock(mutex_);
    held_.clear();
}

std::string read_probed_images(const std::vector<std::string>& words, const scene::BeginLimits& begin_limits) {
    const json questions = json::from_msgpack(std::cin);
    std::uint64_t at = whole_pages(size_of_file(STDIN_FILENO));
    for (const json& question : questions) {
        const std::vector<std::uint8_t>& bytes = question.at(2).get_binary();
        image::open_decoder(question.at(0).get<std::string>(), std::as_bytes(std::span(bytes)),
                            question.at(1).get<std::string>());
        begin_limits();
        at = answer(question, words.at(0) == "headers", at);
        scene::write_from_probe(".");
    }
    return {};
}

int probe_sound(const std::filesystem::path& file) {
    if (const std::string why = core::why_no_plain_file(file); !why.empty())
        throw core::Error("reading", file.string(), why);
    const std::vector<std::string> words{"sound", file.string()};
    if (!scene::Probe::is_possible()) return 2;
    return scene::read_in_probe(words, words[1], film_limits(file), InterruptGuard::requested) == "1" ? 1 : 2;
}

scene::ProbeLimits film_limits(const std::filesystem::path& film) {
    // chosen: 2 GiB and 60 bytes per byte of the file hold the largest pictures and their records; the time is unknown.
    std::error_code failure;
    const std::uintmax_t size = std::filesystem::file_size(film, failure);
    return {(std::uintmax_t{2} << 30) + 60 * (failure ? 0 : size), 0, 0};
}

}  // namespace render2mpeg::app
