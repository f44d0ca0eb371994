#include "vdb_file.h"

#include <openvdb/openvdb.h>

namespace render2mpeg::test {
namespace {

void settle(openvdb::GridBase& grid, const std::string& name, const VdbFile::Place& place) {
    openvdb::Mat4d matrix;
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) matrix(c, r) = place.object_from_index[c][r];
    grid.setName(name);
    grid.setTransform(openvdb::math::Transform::createLinearTransform(matrix));
    grid.setGridClass(place.level_set ? openvdb::GRID_LEVEL_SET : openvdb::GRID_FOG_VOLUME);
    grid.setSaveFloatAsHalf(place.half);
}

template <class Grid, class Value>
typename Grid::Ptr filled(const VdbFile::Place& place, const Value& value) {
    const typename Grid::Ptr grid = Grid::create();
    auto accessor = grid->getAccessor();
    for (int x = place.low.x; x <= place.high.x; ++x)
        for (int y = place.low.y; y <= place.high.y; ++y)
            for (int z = place.low.z; z <= place.high.z; ++z)
                accessor.setValue(openvdb::Coord(x, y, z), value(glm::ivec3(x, y, z)));
    return grid;
}

}  // namespace

struct VdbFile::Grids {
    openvdb::GridPtrVec all;
};

VdbFile::VdbFile() : grids_(std::make_unique<Grids>()) {
    openvdb::initialize();
}
VdbFile::~VdbFile() = default;

VdbFile& VdbFile::add(const std::string& name, const Place& place, const Amount& amount) {
    grids_->all.push_back(filled<openvdb::FloatGrid>(place, amount));
    settle(*grids_->all.back(), name, place);
    return *this;
}

VdbFile& VdbFile::add(const std::string& name, const Place& place, const Vector& vector) {
    grids_->all.push_back(filled<openvdb::Vec3SGrid>(place, [&](glm::ivec3 at) {
        const glm::vec3 v = vector(at);
        return openvdb::Vec3s(v.x, v.y, v.z);
    }));
    settle(*grids_->all.back(), name, place);
    return *this;
}

VdbFile& VdbFile::add_even(const std::string& name, const Place& place, float value) {
    const openvdb::FloatGrid::Ptr grid = openvdb::FloatGrid::create();
    grid->fill({openvdb::Coord(place.low.x, place.low.y, place.low.z),
                openvdb::Coord(place.high.x, place.high.y, place.high.z)},
               value);
    settle(*grid, name, place);
    grids_->all.push_back(grid);
    return *this;
}

VdbFile& VdbFile::add_frustum(const std::string& name) {
    add(name, {}, [](glm::ivec3) { return 1.0f; });
    grids_->all.back()->setTransform(openvdb::math::Transform::createFrustumTransform(
        openvdb::BBoxd(openvdb::Vec3d(0), openvdb::Vec3d(10)), 0.5, 2));
    return *this;
}

VdbFile& VdbFile::add_whole_numbers(const std::string& name) {
    grids_->all.push_back(openvdb::Int32Grid::create());
    settle(*grids_->all.back(), name, {});
    return *this;
}

std::filesystem::path VdbFile::write(const std::filesystem::path& file) const {
    openvdb::io::File(file.string()).write(grids_->all);
    return file;
}

}  // namespace render2mpeg::test
