#pragma once
// Values in a checked file that the very same program reads again.
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <string_view>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/picture.h"
#include "core/plane.h"
#include "core/visible.h"

namespace render2mpeg::core {

/// Bytes of a file in blocks, with a checksum of all.
class ArchiveBlocks {
    struct Head {
        std::uint64_t mark = 0, bytes = 0, checksum = 0;
    };

  public:
    /// Bytes before the first value.
    static constexpr std::size_t header_bytes = sizeof(Head);

  protected:
    using Header = Head;
    static constexpr std::size_t words = 8192;
    /// Adds the block to the checksum, by words: as quick as memory [FNV].
    void sum_up();

    std::array<std::uint64_t, words> block_{};
    std::size_t used_ = 0;  ///< bytes of the block
    std::uint64_t checksum_ = 0xcbf29ce484222325ull;
};

/// Writes a file that has its name once it is whole. A type's values are told by `archive(archive, value)` beside it,
/// which names all members in a structured binding, those that it leaves out as well: one that is added and forgotten
/// does not compile.
class ArchiveWriter : public ArchiveBlocks {
  public:
    /// `mark`: of what it holds, and of whom.
    ArchiveWriter(const std::filesystem::path& file, std::uint64_t mark);
    ArchiveWriter(const ArchiveWriter&) = delete;
    ArchiveWriter& operator=(const ArchiveWriter&) = delete;
    /// Removes what is not finished.
    ~ArchiveWriter();

    void bytes(const void* from, std::size_t count);
    /// Throws core::Error where it could not be written.
    void finish();

    template <class... Values>
    void operator()(Values&... values) {
        (one(values), ...);
    }

  private:
    template <class Value>
    void one(Value& value);
    void flush();

    std::filesystem::path file_, part_;
    std::ofstream stream_;
    std::uint64_t mark_, total_ = 0;
};

/// Reads what ArchiveWriter wrote.
class ArchiveReader : public ArchiveBlocks {
  public:
    /// None where the file is missing, torn or damaged, or bears another mark.
    static std::unique_ptr<ArchiveReader> open(const std::filesystem::path& file, std::uint64_t mark);

    /// Throws core::Error behind the end.
    void bytes(void* to, std::size_t count);
    /// The number of the values that follow, of so many bytes each at least.
    std::size_t count(std::size_t least);
    /// Throws core::Error where fewer than so many values of so many bytes follow.
    void expect(std::uint64_t values, std::size_t bytes) const;

    template <class... Values>
    void operator()(Values&... values) {
        (one(values), ...);
    }

  private:
    ArchiveReader() = default;
    template <class Value>
    void one(Value& value);
    void fill();

    std::filesystem::path file_;
    std::ifstream stream_;
    std::uint64_t left_ = 0;  ///< bytes that were not given yet
    std::size_t given_ = 0;   ///< of the block
};

template <class A, class T>
concept Archived = requires(A& a, T& value) {
    archive(a, value);
};

template <class Value>
void ArchiveWriter::one(Value& value) {
    if constexpr (Archived<ArchiveWriter, Value>) {
        archive(*this, value);
    } else {
        static_assert(std::is_trivially_copyable_v<Value> && !std::is_pointer_v<Value>);
        bytes(&value, sizeof(Value));
    }
}

template <class Value>
void ArchiveReader::one(Value& value) {
    if constexpr (Archived<ArchiveReader, Value>) {
        archive(*this, value);
    } else if constexpr (std::is_same_v<Value, bool>) {
        std::uint8_t byte = 0;
        bytes(&byte, 1);
        value = byte != 0;
    } else {
        static_assert(std::is_trivially_copyable_v<Value> && !std::is_pointer_v<Value>);
        bytes(static_cast<void*>(&value), sizeof(Value));
    }
}

/// Values of a list: as they lie where they are plain.
template <class A, class Values>
void archive_all(A& a, Values&& values) {
    using Value = std::remove_reference_t<decltype(*values.begin())>;
    if constexpr (std::is_trivially_copyable_v<Value>) {
        if (!values.empty()) a.bytes(values.data(), values.size() * sizeof(Value));
    } else {
        for (auto& value : values) a(value);
    }
}

template <class T>
void archive(ArchiveWriter& a, std::vector<T>& values) {
    auto count = static_cast<std::uint64_t>(values.size());
    a(count);
    archive_all(a, values);
}
template <class T>
void archive(ArchiveReader& a, std::vector<T>& values) {
    values.clear();
    const std::size_t count = a.count(std::is_trivially_copyable_v<T> ? sizeof(T) : 1);
    if constexpr (std::is_trivially_copyable_v<T>) {
        values.resize(count);
        archive_all(a, values);
    } else {
        for (std::size_t i = 0; i < count; ++i) a(values.emplace_back());
    }
}

template <class A, class T>
void archive(A& a, Plane<T>& plane) {
    int width = plane.width(), height = plane.height();
    a(width, height);
    if constexpr (std::is_same_v<A, ArchiveReader>) {
        if (width < 0 || height < 0) throw Error("reading a plane: it has no size");
        a.expect(static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height),
                 std::is_trivially_copyable_v<T> ? sizeof(T) : 1);
        plane = Plane<T>(width, height);
    }
    archive_all(a, plane.values());
}

template <class A, class T>
void archive(A& a, std::optional<T>& value) {
    bool there = value.has_value();
    a(there);
    if constexpr (std::is_same_v<A, ArchiveReader>) value = there ? std::optional<T>(T()) : std::nullopt;
    if (there) a(*value);
}

template <class A, class T, std::size_t count>
requires(!std::is_trivially_copyable_v<T>) void archive(A& a, std::array<T, count>& values) {
    for (T& value : values) a(value);
}

template <class A, class T>
void archive(A& a, std::shared_ptr<const T>& value) {
    bool there = value != nullptr;
    a(there);
    std::shared_ptr<T> now;
    if constexpr (std::is_same_v<A, ArchiveReader>) {
        if (there) now = std::make_shared<T>();
        value = now;
    } else {
        now = std::const_pointer_cast<T>(value);
    }
    if (there) a(*now);
}

template <class A>
void archive(A& a, Visible& v) {
    auto& [frame, address, depth, geometric_normal, shading_normal, material, kind] = v;
    a(frame, address, depth, geometric_normal, shading_normal, material, kind);
}

/// Pairs of a map, in any order.
template <class A, class Map>
void archive_map(A& a, Map& map) {
    std::vector<typename Map::key_type> keys;
    for (const auto& [key, value] : map) keys.push_back(key);
    a(keys);
    if constexpr (std::is_same_v<A, ArchiveReader>) map.clear();
    for (const auto& key : keys) a(map[key]);
}
template <class A, class K, class V>
void archive(A& a, std::map<K, V>& map) {
    archive_map(a, map);
}
template <class A, class K, class V>
void archive(A& a, std::unordered_map<K, V>& map) {
    archive_map(a, map);
}

}  // namespace render2mpeg::core
