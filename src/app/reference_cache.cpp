#include "app/reference_cache.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"

namespace render2mpeg::app {
namespace {

/// Pixels of each frame whose light is in its name.
constexpr int probed = 256;

/// [FNV], 64 bits.
class Hash {
  public:
    void add(const void* bytes, std::size_t count) {
        const auto* b = static_cast<const unsigned char*>(bytes);
        for (std::size_t i = 0; i < count; ++i) value_ = (value_ ^ b[i]) * 0x100000001b3u;
    }
    template <class T>
    void add(const core::Plane<T>& plane) {
        add(plane.values().data(), plane.size() * sizeof(T));
    }
    void add(const std::string& text) { add(text.data(), text.size() + 1); }
    void add(std::int64_t value) { add(&value, sizeof value); }
    void add(float value) { add(&value, sizeof value); }
    std::uint64_t value() const { return value_; }

  private:
    std::uint64_t value_ = 0xcbf29ce484222325u;
};

/// What a file begins with.
struct Header {
    char mark[8] = {'r', '2', 'm', 'r', 'e', 'f', '1', '\n'};
    std::int32_t width = 0, height = 0;
    double seconds = 0;
    std::uint64_t checksum = 0;  ///< of the light
};

std::uint64_t checksum_of(const core::Plane<glm::vec3>& light) {
    Hash hash;
    hash.add(light);
    return hash.value();
}

}  // namespace

ReferenceCache::ReferenceCache(std::filesystem::path folder) : folder_(std::move(folder)) {
    std::error_code error;
    std::filesystem::create_directories(folder_, error);
    if (!std::filesystem::is_directory(folder_, error))
        throw core::Error("keeping references in", folder_.string(), "this is no folder, and none can be made");
}

std::filesystem::path ReferenceCache::file_of(std::uint64_t key) const {
    return folder_ / fmt::format("{:016x}.light", key);
}

std::uint64_t ReferenceCache::key_of(const Production& film, renderer::Renderer& renderer, const scene::Snapshot& world,
                                     const renderer::Seen& seen) const {
    if (folder_.empty()) return 0;
    Hash hash;
    const renderer::Settings& s = film.rendering;
    hash.add(std::string(RENDER2MPEG_VERSION));
    hash.add(std::string(core::name_of(s.isa)));
    for (const std::int64_t value :
         {world.frame, std::int64_t{s.format.width}, std::int64_t{s.format.height}, std::int64_t{s.samples},
          std::int64_t{s.vpls}, std::int64_t{s.direct_points}, static_cast<std::int64_t>(s.clamp),
          static_cast<std::int64_t>(s.bounces), static_cast<std::int64_t>(s.seed)})
        hash.add(value);
    hash.add(seen.visible.depth);
    hash.add(seen.visible.material);
    hash.add(seen.unscattered);
    core::Radiance nothing;
    nothing.frame = world.frame;
    nothing.combined = core::Plane<glm::vec3>(s.format.width, s.format.height, glm::vec3(0));
    nothing.capped = core::Plane<std::uint8_t>(s.format.width, s.format.height, 0);
    for (const renderer::AuditedPixel& p :
         renderer.audit(world, seen, core::ToleranceMap::reference(), nothing, probed)) {
        hash.add(p.luminance);
        hash.add(p.chroma);
    }
    return hash.value();
}

std::optional<KeptReference> ReferenceCache::find(std::uint64_t key, int width, int height) const {
    if (folder_.empty()) return std::nullopt;
    std::ifstream stream(file_of(key), std::ios::binary);
    Header header;
    const Header right;
    if (!stream.read(reinterpret_cast<char*>(&header), sizeof header)) return std::nullopt;
    if (std::memcmp(header.mark, right.mark, sizeof right.mark) != 0 || header.width != width ||
        header.height != height || !(header.seconds >= 0))
        return std::nullopt;
    KeptReference kept{core::Plane<glm::vec3>(width, height), header.seconds};
    const auto size = static_cast<std::streamsize>(kept.light.size() * sizeof(glm::vec3));
    if (!stream.read(reinterpret_cast<char*>(kept.light.values().data()), size)) return std::nullopt;
    if (stream.get() != std::ifstream::traits_type::eof() || checksum_of(kept.light) != header.checksum)
        return std::nullopt;
    return kept;
}

void ReferenceCache::keep(std::uint64_t key, const KeptReference& reference) const {
    if (folder_.empty()) return;
    Header header;
    header.width = reference.light.width();
    header.height = reference.light.height();
    header.seconds = reference.seconds;
    header.checksum = checksum_of(reference.light);
    // Whole or not at all.
    const std::filesystem::path unfinished = file_of(key).string() + fmt::format(".{}.partial", getpid());
    std::error_code ignored;
    {
        std::ofstream stream(unfinished, std::ios::binary);
        stream.write(reinterpret_cast<const char*>(&header), sizeof header);
        stream.write(reinterpret_cast<const char*>(reference.light.values().data()),
                     static_cast<std::streamsize>(reference.light.size() * sizeof(glm::vec3)));
        if (stream.flush()) {
            stream.close();
            std::filesystem::rename(unfinished, file_of(key), ignored);
            return;
        }
    }
    std::filesystem::remove(unfinished, ignored);
}

}  // namespace render2mpeg::app
