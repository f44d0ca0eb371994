#include "scene/gltf/meshopt.h"

#include <meshoptimizer.h>

#include <string>

#include "scene/model/wording.h"

namespace render2mpeg::scene::gltf {
namespace {

void undo_filter(const Element& extension, std::size_t count, std::size_t stride, std::vector<std::byte>& out) {
    const std::string filter = extension.string("filter", "NONE");
    if (filter == "OCTAHEDRAL") {
        if (stride != 4 && stride != 8) extension.refuse("octahedral values of " + std::to_string(stride) + " bytes");
        meshopt_decodeFilterOct(out.data(), count, stride);
    } else if (filter == "QUATERNION") {
        if (stride != 8) extension.refuse("quaternions of " + std::to_string(stride) + " bytes");
        meshopt_decodeFilterQuat(out.data(), count, stride);
    } else if (filter == "EXPONENTIAL") {
        meshopt_decodeFilterExp(out.data(), count, stride);
    } else if (filter != "NONE") {
        extension.refuse("filter " + in_quotes(filter) + " is none of the extension's");
    }
}

}  // namespace

std::vector<std::byte> decode_meshopt(const Element& extension, std::span<const std::byte> bytes) {
    const std::size_t count = extension.required_size("count"), stride = extension.required_size("byteStride");
    const std::string mode = extension.string("mode", "");
    const bool attributes = mode == "ATTRIBUTES", triangles = mode == "TRIANGLES", indices = mode == "INDICES";
    if (!attributes && !triangles && !indices)
        extension.refuse("mode " + in_quotes(mode) + " is none of the extension's");
    const bool fits = attributes ? stride >= 4 && stride <= 256 && stride % 4 == 0 : stride == 2 || stride == 4;
    if (!fits) extension.refuse("has a stride of " + std::to_string(stride) + " bytes");
    if (triangles && count % 3 != 0)
        extension.refuse("has " + std::to_string(count) + " corners, which are no whole number of triangles");
    // Sixteen values of a byte take two bits at least, a triangle and an index one byte.
    const std::size_t most = attributes ? 64 * bytes.size() / stride : (triangles ? 3 : 1) * bytes.size();
    if (count > most)
        extension.refuse("says " + counted(count, "element") + ", which " + std::to_string(bytes.size()) +
                         " bytes cannot hold");

    std::vector<std::byte> out(count * stride);
    const auto* from = reinterpret_cast<const unsigned char*>(bytes.data());
    int fault = 0;
    if (attributes)
        fault = meshopt_decodeVertexBuffer(out.data(), count, stride, from, bytes.size());
    else if (triangles)
        fault = meshopt_decodeIndexBuffer(out.data(), count, stride, from, bytes.size());
    else
        fault = meshopt_decodeIndexSequence(out.data(), count, stride, from, bytes.size());
    if (fault != 0) extension.refuse("does not decode");
    if (attributes) undo_filter(extension, count, stride, out);
    return out;
}

}  // namespace render2mpeg::scene::gltf
