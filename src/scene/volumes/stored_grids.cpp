#include "scene/volumes/stored_grids.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <new>
#include <span>
#include <type_traits>

#include "core/error.h"
#include "scene/module/vdb.h"

namespace render2mpeg::scene {
namespace {

/// Bytes at the end of a file.
class Writer {
  public:
    explicit Writer(int file) : file_(file) { waiting_.reserve(most_waiting); }

    template <class T>
    void put(const T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        const auto bytes = std::as_bytes(std::span(&value, 1));
        if (waiting_.size() + bytes.size() > most_waiting) flush();
        waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
    }

    void flush() {
        for (std::size_t done = 0; done < waiting_.size();) {
            const ssize_t n =
                pwrite(file_, waiting_.data() + done, waiting_.size() - done, static_cast<off_t>(at_ + done));
            if (n == 0 || (n < 0 && errno != EINTR)) throw std::bad_alloc();
            if (n > 0) done += static_cast<std::size_t>(n);
        }
        at_ += waiting_.size();
        waiting_.clear();
    }

  private:
    static constexpr std::size_t most_waiting = std::size_t{1} << 20;
    int file_;
    std::size_t at_ = 0;
    std::vector<std::byte> waiting_;
};

class Reader {
  public:
    Reader(int file, const std::string& name) : file_(file), name_(name) {
        struct stat state {};
        if (fstat(file, &state) == 0) size_ = static_cast<std::size_t>(state.st_size);
    }

    template <class T>
    T get() {
        T value;
        get(&value, sizeof(value));
        return value;
    }

    void get(void* into, std::size_t bytes) {
        expect(bytes <= left());
        for (std::size_t done = 0; done < bytes;) {
            const ssize_t n =
                pread(file_, static_cast<std::byte*>(into) + done, bytes - done, static_cast<off_t>(at_ + done));
            expect(n > 0 || (n < 0 && errno == EINTR));
            if (n > 0) done += static_cast<std::size_t>(n);
        }
        at_ += bytes;
    }

    std::size_t left() const { return size_ - at_; }
    void expect(bool holds) const {
        if (!holds) throw core::Error("reading", name_, "its grids did not arrive from the process that read them");
    }

  private:
    int file_;
    const std::string& name_;
    std::size_t at_ = 0, size_ = 0;
};

template <class T>
void store(const core::SparseGrid<T>& grid, Writer& writer) {
    writer.put(grid.low());
    writer.put(grid.size());
    writer.put(static_cast<std::uint64_t>(grid.count()));
    grid.each([&](glm::ivec3 place, const auto& brick) {
        writer.put(place - grid.low());
        writer.put(brick);
    });
}

template <class T>
void restore(core::SparseGrid<T>& grid, Reader& reader) {
    using Grid = core::SparseGrid<T>;
    const auto low = reader.get<glm::ivec3>(), size = reader.get<glm::ivec3>();
    const auto count = reader.get<std::uint64_t>();
    reader.expect(std::min({size.x, size.y, size.z}) >= 0 && count <= reader.left() / sizeof(typename Grid::Brick));
    const double places = double(size.x) * double(size.y) * double(size.z);
    reader.expect(places <= static_cast<double>(most_brick_places));
    constexpr int farthest = 1 << 24;
    for (int k = 0; k < 3; ++k) reader.expect(std::abs(static_cast<double>(low[k])) < farthest && size[k] < farthest);
    grid = Grid(low, size);
    grid.reserve(count);
    for (std::uint64_t i = 0; i < count; ++i) {
        const auto at = reader.get<glm::ivec3>();
        reader.expect(glm::all(glm::greaterThanEqual(at, glm::ivec3(0))) && glm::all(glm::lessThan(at, size)));
        reader.get(&grid.add(low + at), sizeof(typename Grid::Brick));
    }
}

}  // namespace

void store_grids(const VolumeGrids& grids, int file) {
    Writer writer(file);
    writer.put(grids.object_from_index);
    store(grids.density, writer);
    store(grids.temperature, writer);
    store(grids.color, writer);
    writer.flush();
}

VolumeGrids stored_grids(int file, const std::string& name) {
    Reader reader(file, name);
    VolumeGrids grids;
    grids.object_from_index = reader.get<glm::dmat4>();
    restore(grids.density, reader);
    restore(grids.temperature, reader);
    restore(grids.color, reader);
    return grids;
}

}  // namespace render2mpeg::scene
