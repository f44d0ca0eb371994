// The module that reads OpenVDB's files.
#include "scene/module/vdb.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/Interpolation.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <optional>

#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::scene {
namespace {

namespace fs = std::filesystem;
using openvdb::FloatGrid;
using openvdb::GridBase;
using VectorGrid = openvdb::Vec3SGrid;
using openvdb::CoordBBox;

constexpr int brick_side = core::SparseGrid<float>::brick_side;

float ours(float value) {
    return value;
}
glm::vec3 ours(const openvdb::Vec3s& value) {
    return {value.x(), value.y(), value.z()};
}
bool is_zero(float value) {
    return value == 0;
}
bool is_zero(glm::vec3 value) {
    return value == glm::vec3(0);
}

/// Rows of OpenVDB's vectors are columns here.
glm::dmat4 matrix_of(const GridBase& grid) {
    const openvdb::Mat4d m = grid.transform().baseMap()->getAffineMap()->getMat4();
    glm::dmat4 out;
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) out[c][r] = m(c, r);
    return out;
}

bool is_usable(const glm::dmat4& m) {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r)
            if (!std::isfinite(m[c][r])) return false;
    const double size = glm::determinant(glm::dmat3(m));
    return std::isfinite(size) && size != 0 && std::isfinite(1 / size);
}

bool are_same(const glm::dmat4& a, const glm::dmat4& b) {
    // Half a thousandth of a voxel, within a thousand voxels.
    const glm::dmat4 between = glm::inverse(a) * b;
    double off = 0;
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) off = std::max(off, std::abs(between[c][r] - (c == r ? 1.0 : 0.0)));
    return off < 5e-7;
}

/// What a message of OpenVDB's says, on one line.
std::string cause_of(const std::exception& error) {
    std::string text = error.what();
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < 32; }, ' ');
    return "OpenVDB does not read it: " + text.substr(0, 200);
}

/// What a grid's file says of it, where its writer told.
std::optional<double> told(const GridBase& grid, const char* key) {
    const auto value = grid.getMetadata<openvdb::Int64Metadata>(key);
    return value ? std::optional(static_cast<double>(value->value())) : std::nullopt;
}

/// Bytes that a grid's bricks and their table take, about: as in OpenVDB's leaves, or as its voxels where it is even.
/// At voxels of another volume as many times more.
double bytes_of(const GridBase& grid, const glm::dmat4& object_from_index) {
    const bool is_vector = grid.isType<VectorGrid>();
    const auto leaves = told(grid, GridBase::META_FILE_MEM_BYTES), voxels = told(grid, GridBase::META_FILE_VOXEL_COUNT);
    const double all =
        std::max(leaves.value_or(0), voxels.value_or(0) * (is_vector ? sizeof(glm::vec3) : sizeof(float)));
    const auto volume_of = [](const glm::dmat4& m) { return std::abs(glm::determinant(glm::dmat3(m))); };
    return std::clamp(all * volume_of(matrix_of(grid)) / volume_of(object_from_index), 0.0, double(most_grid_bytes));
}

/// Open files, of which the first that has a grid counts.
class Source {
  public:
    explicit Source(std::span<const fs::path> files) : name_(files.front().string()) {
        for (const fs::path& file : files) {
            files_.push_back(std::make_unique<openvdb::io::File>(file.string()));
            guarded([&] { files_.back()->open(false); });
        }
    }

    [[noreturn]] void refuse(const std::string& grid, const std::string& cause) const {
        throw core::Error("reading", name_, "grid \"" + grid + "\"", cause);
    }

    bool has(const std::string& grid) const { return file_with(grid) != nullptr; }

    /// A grid without its voxels, if it is one that can be read.
    template <class Grid>
    GridBase::Ptr head(const std::string& grid) {
        if (!has(grid)) refuse(grid, "there is none; " + grids());
        GridBase::Ptr head;
        guarded([&] { head = file_with(grid)->readGridMetadata(grid); });
        if (!head || !head->isType<Grid>())
            refuse(grid, "holds values of type " + (head ? head->valueType() : "?") + "; " +
                             (std::is_same_v<Grid, FloatGrid> ? "float" : "vec3s") + " is read here");
        if (head->getGridClass() == openvdb::GRID_LEVEL_SET) refuse(grid, "is a level set, whose values are distances");
        if (!head->transform().isLinear()) refuse(grid, "its transform is a frustum; only affine ones are read");
        if (!is_usable(matrix_of(*head))) refuse(grid, "its transform has no inverse");
        return head;
    }

    template <class Grid>
    typename Grid::Ptr grid(const std::string& grid) {
        head<Grid>(grid);
        typename Grid::Ptr read;
        guarded([&] {
            read = openvdb::gridPtrCast<Grid>(file_with(grid)->readGrid(grid));
            // Beyond what is stored, there is nothing.
            if (!is_zero(ours(read->background())))
                openvdb::tools::changeBackground(read->tree(), openvdb::zeroVal<typename Grid::ValueType>());
        });
        return read;
    }

  private:
    template <class Do>
    void guarded(const Do& todo) const {
        try {
            todo();
        } catch (const std::bad_alloc&) {
            throw;
        } catch (const std::exception& error) {
            throw core::Error("reading", name_, cause_of(error));
        }
    }

    openvdb::io::File* file_with(const std::string& grid) const {
        openvdb::io::File* first = nullptr;
        guarded([&] {
            const auto file =
                std::find_if(files_.begin(), files_.end(), [&](const auto& f) { return f->hasGrid(grid); });
            if (file != files_.end()) first = file->get();
        });
        return first;
    }

    std::string grids() const {
        std::string all;
        for (const auto& file : files_)
            for (auto name = file->beginName(); name != file->endName(); ++name)
                all += (all.empty() ? "there are \"" : ", \"") + name.gridName() + "\"";
        return all.empty() ? "the file has no grids" : all;
    }

    std::string name_;
    std::vector<std::unique_ptr<openvdb::io::File>> files_;
};

/// Calls `todo` with the box, the leaf (null: even) and the value of each part of a tree that holds more than zeros.
template <class Tree, class Do>
void each_part(const Tree& tree, const Do& todo) {
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
        const auto* const first = leaf->buffer().data();
        if (std::any_of(first, first + Tree::LeafNodeType::SIZE, [](const auto& v) { return !is_zero(ours(v)); }))
            todo(leaf->getNodeBoundingBox(), &*leaf, ours(*first));
    }
    auto tile = tree.cbeginValueOn();
    tile.setMaxDepth(Tree::ValueOnCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile)
        if (!is_zero(ours(*tile))) {
            CoordBBox box;
            tile.getBoundingBox(box);
            todo(box, static_cast<const typename Tree::LeafNodeType*>(nullptr), ours(*tile));
        }
}

/// Bricks from `low` to before `high`.
struct Places {
    glm::i64vec3 low{0}, high{0};

    void hold(const Places& other) {
        const bool first = high == low;
        low = first ? other.low : glm::min(low, other.low);
        high = first ? other.high : glm::max(high, other.high);
    }
    double count() const {
        const glm::dvec3 size(high - low);
        return size.x * size.y * size.z;
    }
    template <class Do>
    void each(const Do& todo) const {
        for (auto z = low.z; z < high.z; ++z)
            for (auto y = low.y; y < high.y; ++y)
                for (auto x = low.x; x < high.x; ++x) todo(glm::ivec3(x, y, z));
    }
};

Places places_of(const CoordBBox& box) {
    Places places;
    for (int k = 0; k < 3; ++k) {
        places.low[k] = box.min()[k] >> 3;
        places.high[k] = (box.max()[k] >> 3) + 1;
    }
    return places;
}

/// Bricks in which a box has a share between its samples and the next, seen from another index space.
Places places_of(const CoordBBox& box, const glm::dmat4& target_from_source) {
    VolumeBox voxels;
    for (int corner = 0; corner < 8; ++corner) {
        glm::dvec4 p(0, 0, 0, 1);
        for (int k = 0; k < 3; ++k) p[k] = corner >> k & 1 ? box.max()[k] + 1.0 : box.min()[k] - 1.0;
        voxels.hold(glm::dvec3(target_from_source * p));
    }
    // Bricks so far away are more than a grid can have.
    constexpr double farthest = 1e9;
    Places places;
    for (int k = 0; k < 3; ++k) {
        places.low[k] = std::int64_t(std::floor(std::clamp(voxels.low[k], -farthest, farthest) / brick_side));
        places.high[k] = std::int64_t(std::floor(std::clamp(voxels.high[k], -farthest, farthest) / brick_side)) + 1;
    }
    return places;
}

/// Makes grids, within the limits of a file.
class Maker {
  public:
    Maker(Source& source, const MakeRoom& room) : source_(source), room_(room) {}

    template <class T>
    core::SparseGrid<T> empty(const std::string& name, const Places& places) {
        if (places.count() > static_cast<double>(most_brick_places))
            source_.refuse(name, "spans " + spans(places) + " voxels; at most 2048^3, or as many otherwise, are read");
        core::SparseGrid<T> grid(glm::ivec3(places.low), glm::ivec3(places.high - places.low));
        take(name, grid.bytes());
        return grid;
    }

    /// Refuses what takes too much.
    void take(const std::string& name, double bytes) {
        bytes_ += bytes;
        if (bytes_ > static_cast<double>(most_grid_bytes))
            source_.refuse(name, "takes, with those before it, more than 2 GiB; scale the file's voxels up");
        // chosen: by 16 MiB, since bricks come one by one (1 .. 64); twice, since lists move as they grow.
        constexpr double step = 1 << 24;
        if (bytes_ <= room_made_) return;
        const double more = std::ceil((bytes_ - room_made_) / step) * step;
        room_(static_cast<std::uintmax_t>(2 * more));
        room_made_ += more;
    }

    /// The same voxels.
    template <class T, class Grid>
    core::SparseGrid<T> copy(const std::string& name, const Grid& from) {
        Places all;
        double bricks = 0;
        each_part(from.tree(), [&](const CoordBBox& box, auto, auto) {
            all.hold(places_of(box));
            bricks += places_of(box).count();
        });
        core::SparseGrid<T> grid = empty<T>(name, all);
        take(name, bricks * sizeof(typename core::SparseGrid<T>::Brick));
        grid.reserve(static_cast<std::size_t>(bricks));
        each_part(from.tree(), [&](const CoordBBox& box, const auto* leaf, T value) {
            const Places places = places_of(box);
            if (leaf == nullptr) {
                places.each([&](glm::ivec3 place) { grid.add(place).fill(value); });
                return;
            }
            auto& brick = grid.add(glm::ivec3(places.low));
            for (int x = 0; x < brick_side; ++x)  // OpenVDB's leaves have z fastest
                for (int y = 0; y < brick_side; ++y)
                    for (int z = 0; z < brick_side; ++z)
                        brick[grid.place_in_brick({x, y, z})] =
                            ours(leaf->getValue(static_cast<openvdb::Index>((x << 6) + (y << 3) + z)));
        });
        return grid;
    }

    /// Samples at the voxels of another index space.
    template <class T, class Grid>
    core::SparseGrid<T> sampled(const std::string& name, const Grid& from, const glm::dmat4& source_from_target) {
        const glm::dmat4 target_from_source = glm::inverse(source_from_target);
        Places all;
        each_part(from.tree(), [&](const CoordBBox& box, auto, auto) { all.hold(places_of(box, target_from_source)); });
        core::SparseGrid<T> grid = empty<T>(name, all);
        std::vector<char> met(static_cast<std::size_t>(all.count()), 0);
        const auto slot = [&](glm::ivec3 place) {
            const glm::i64vec3 at = glm::i64vec3(place) - all.low, size = all.high - all.low;
            return static_cast<std::size_t>(at.x + size.x * (at.y + size.y * at.z));
        };
        each_part(from.tree(), [&](const CoordBBox& box, auto, auto) {
            places_of(box, target_from_source).each([&](glm::ivec3 place) { met[slot(place)] = 1; });
        });
        const auto accessor = from.getConstAccessor();
        all.each([&](glm::ivec3 place) {
            if (!met[slot(place)]) return;
            typename core::SparseGrid<T>::Brick brick;
            for (std::size_t i = 0; i < brick.size(); ++i) {
                const glm::ivec3 voxel = core::SparseGrid<T>::voxel(place, static_cast<int>(i));
                const glm::dvec4 p = source_from_target * glm::dvec4(voxel, 1);
                brick[i] = ours(openvdb::tools::BoxSampler::sample(accessor, openvdb::Vec3R(p.x, p.y, p.z)));
            }
            if (std::all_of(brick.begin(), brick.end(), [](T v) { return is_zero(v); })) return;
            take(name, sizeof(brick));
            grid.add(place) = brick;
        });
        return grid;
    }

    template <class T, class Grid>
    core::SparseGrid<T> made(const std::string& name, const Grid& from, const glm::dmat4& object_from_index) {
        const glm::dmat4 own = matrix_of(from);
        const glm::dmat4 source_from_target = glm::inverse(own) * object_from_index;
        return are_same(own, object_from_index) ? copy<T>(name, from) : sampled<T>(name, from, source_from_target);
    }

  private:
    static std::string spans(const Places& places) {
        const glm::i64vec3 size = std::int64_t{brick_side} * (places.high - places.low);
        return std::to_string(size.x) + " x " + std::to_string(size.y) + " x " + std::to_string(size.z);
    }

    Source& source_;
    const MakeRoom& room_;
    double bytes_ = 0, room_made_ = 0;
};

/// Corrects values by `right`, and tells how many changed.
template <class Grid, class Right>
void mend(Grid& grid, const std::string& name, const char* became, const Right& right,
          std::vector<std::string>& notes) {
    std::size_t mended = 0;
    for (auto value = grid.tree().beginValueAll(); value; ++value) {
        const auto is = *value;
        const auto should = right(is);
        if (is == should) continue;
        value.setValue(should);
        ++mended;
    }
    if (mended > 0)
        notes.push_back("grid \"" + name + "\": " + std::to_string(mended) + (mended == 1 ? " value" : " values") +
                        " " + became);
}

void mend_amounts(FloatGrid& grid, const std::string& name, std::vector<std::string>& notes) {
    mend(
        grid, name, "below 0 or not finite became 0", [](float v) { return v >= 0 && std::isfinite(v) ? v : 0.0f; },
        notes);
}

/// The colour of a grid, or of three with an amount each.
VectorGrid::Ptr color_grid(Source& source, const std::string& name) {
    if (source.has(name) || !source.has(name + "_r")) return source.grid<VectorGrid>(name);
    std::array<FloatGrid::Ptr, 3> channels;
    for (std::size_t k = 0; k < 3; ++k) channels[k] = source.grid<FloatGrid>(name + "_" + "rgb"[k]);
    // Made by the library: its constructor would have all code of such grids compiled here.
    const auto grid = openvdb::gridPtrCast<VectorGrid>(GridBase::createGrid(VectorGrid::gridType()));
    grid->setTransform(channels[0]->transformPtr());
    for (const FloatGrid::Ptr& channel : channels) {
        if (!are_same(matrix_of(*channel), matrix_of(*channels[0])))
            source.refuse(name + "_r", "stands elsewhere than the other two of the colour");
        grid->tree().topologyUnion(channel->tree());
    }
    const std::array accessors{channels[0]->getConstAccessor(), channels[1]->getConstAccessor(),
                               channels[2]->getConstAccessor()};
    for (auto value = grid->beginValueOn(); value; ++value) {
        const openvdb::Coord at = value.getCoord();
        value.setValue({accessors[0].getValue(at), accessors[1].getValue(at), accessors[2].getValue(at)});
    }
    return grid;
}

class Reader : public VdbReader {
  public:
    Reader() { openvdb::initialize(); }

    VolumeGrids read(std::span<const fs::path> files, const Volume& volume, std::vector<std::string>& notes,
                     const MakeRoom& room) const override {
        Source source(files);
        Maker maker(source, room);
        VolumeGrids grids;
        {
            const FloatGrid::Ptr density = source.grid<FloatGrid>(volume.density_grid);
            mend_amounts(*density, volume.density_grid, notes);
            grids.object_from_index = matrix_of(*density);
            grids.density = maker.copy<float>(volume.density_grid, *density);
        }
        if (volume.reads_temperature()) {
            const FloatGrid::Ptr temperature = source.grid<FloatGrid>(volume.temperature_grid);
            mend_amounts(*temperature, volume.temperature_grid, notes);
            grids.temperature = maker.made<float>(volume.temperature_grid, *temperature, grids.object_from_index);
        }
        if (!volume.color_grid.empty()) {
            const VectorGrid::Ptr color = color_grid(source, volume.color_grid);
            const auto right = [](openvdb::Vec3s v) {
                for (int k = 0; k < 3; ++k) v[k] = v[k] >= 0 && std::isfinite(v[k]) ? std::min(v[k], 1.0f) : 0.0f;
                return v;
            };
            mend(*color, volume.color_grid, "became colours from 0 to 1", right, notes);
            grids.color = maker.made<glm::vec3>(volume.color_grid, *color, grids.object_from_index);
        }
        return grids;
    }

    VolumeOutline outline(std::span<const fs::path> files, const Volume& volume) const override {
        Source source(files);
        const GridBase::Ptr density = source.head<FloatGrid>(volume.density_grid);
        const glm::dmat4 object_from_index = matrix_of(*density);
        double bytes = bytes_of(*density, object_from_index);
        if (volume.reads_temperature())
            bytes += bytes_of(*source.head<FloatGrid>(volume.temperature_grid), object_from_index);
        if (const std::string& color = volume.color_grid; !color.empty())
            bytes += source.has(color) || !source.has(color + "_r")
                         ? bytes_of(*source.head<VectorGrid>(color), object_from_index)
                         : 3 * bytes_of(*source.head<FloatGrid>(color + "_r"), object_from_index);
        // Writers seldom leave these out.
        const auto low = density->getMetadata<openvdb::Vec3IMetadata>(GridBase::META_FILE_BBOX_MIN);
        const auto high = density->getMetadata<openvdb::Vec3IMetadata>(GridBase::META_FILE_BBOX_MAX);
        CoordBBox voxels;
        if (low && high) {
            voxels = CoordBBox(openvdb::Coord(low->value()), openvdb::Coord(high->value()));
        } else {
            const FloatGrid::Ptr read = source.grid<FloatGrid>(volume.density_grid);
            voxels = read->evalActiveVoxelBoundingBox();
            bytes += static_cast<double>(read->memUsage());
        }
        VolumeBox box;
        if (voxels.empty()) return {};
        for (int k = 0; k < 3; ++k) box.low[k] = voxels.min()[k] - 0.5, box.high[k] = voxels.max()[k] + 0.5;
        return {box.moved(object_from_index), static_cast<std::uint64_t>(bytes)};
    }
};

}  // namespace
}  // namespace render2mpeg::scene

extern "C" const render2mpeg::scene::VdbReader* render2mpeg_vdb_reader() {
    static const render2mpeg::scene::Reader reader;
    return &reader;
}
