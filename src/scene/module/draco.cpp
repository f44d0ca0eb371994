// The module that decodes Draco's meshes.
#include "scene/module/draco.h"

#include <draco/compression/decode.h>

#include <memory>
#include <stdexcept>

namespace render2mpeg::scene::gltf {
namespace {

DracoMesh::Values values_of(const draco::PointAttribute& attribute, std::size_t vertices, std::uint32_t number) {
    DracoMesh::Values out;
    out.components = attribute.num_components();
    out.normalized = attribute.normalized();
    if (out.components < 1 || out.components > 16)
        throw std::invalid_argument("Draco's attribute " + std::to_string(number) + " has " +
                                    std::to_string(out.components) + " components");
    const auto n = static_cast<std::size_t>(out.components);
    out.values.resize(vertices * n);
    for (std::size_t v = 0; v < vertices; ++v) {
        const draco::AttributeValueIndex index =
            attribute.mapped_index(draco::PointIndex(static_cast<std::uint32_t>(v)));
        if (index.value() >= attribute.size() ||
            !attribute.ConvertValue<float>(index, static_cast<int8_t>(out.components), &out.values[v * n]))
            throw std::invalid_argument("Draco's attribute " + std::to_string(number) + " lacks values");
    }
    return out;
}

class Decoder : public DracoDecoder {
  public:
    DracoMesh decode(std::span<const std::byte> bytes, std::span<const std::uint32_t> attributes) const override {
        draco::DecoderBuffer buffer;
        buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        draco::Decoder decoder;
        auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
        if (!decoded.ok())
            throw std::invalid_argument(std::string("Draco does not decode: ") + decoded.status().error_msg());
        const std::unique_ptr<draco::Mesh> mesh = std::move(decoded).value();

        DracoMesh out;
        out.vertices = mesh->num_points();
        out.corners.reserve(3 * static_cast<std::size_t>(mesh->num_faces()));
        for (draco::FaceIndex f(0); f < mesh->num_faces(); ++f)
            for (int k = 0; k < 3; ++k) {
                const std::uint32_t corner = mesh->face(f)[k].value();
                if (corner >= out.vertices) throw std::invalid_argument("Draco's corners lie beyond its vertices");
                out.corners.push_back(corner);
            }
        for (const std::uint32_t number : attributes) {
            const draco::PointAttribute* attribute = mesh->GetAttributeByUniqueId(number);
            if (attribute == nullptr)
                throw std::invalid_argument("Draco's mesh has no attribute " + std::to_string(number));
            out.attributes.emplace(number, values_of(*attribute, out.vertices, number));
        }
        return out;
    }
};

}  // namespace

}  // namespace render2mpeg::scene::gltf

extern "C" const render2mpeg::scene::gltf::DracoDecoder* render2mpeg_draco_decoder() {
    static const render2mpeg::scene::gltf::Decoder decoder;
    return &decoder;
}
