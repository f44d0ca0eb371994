// No claimed size is allocated: counts must be held by the buffer, or be known otherwise. [glTF2, 3.6.2]
#include "scene/gltf/accessor.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/text.h"
#include "scene/model/wording.h"

namespace render2mpeg::scene::gltf {
namespace {

enum class Component : int { int8 = 5120, uint8 = 5121, int16 = 5122, uint16 = 5123, uint32 = 5125, float32 = 5126 };

std::size_t size_of(Component component) {
    switch (component) {
        case Component::int8:
        case Component::uint8:
            return 1;
        case Component::int16:
        case Component::uint16:
            return 2;
        default:
            return 4;
    }
}

Component component_of(const Element& element) {
    const std::size_t code = element.required_size("componentType");
    if ((code >= 5120 && code <= 5123) || code == 5125 || code == 5126) return static_cast<Component>(code);
    element.refuse("componentType " + std::to_string(code) + " is none of glTF's");
}

int components_of(const Element& accessor) {
    const std::string type = accessor.string("type", "");
    if (type == "SCALAR") return 1;
    if (type == "VEC2") return 2;
    if (type == "VEC3") return 3;
    if (type == "VEC4") return 4;
    if (type == "MAT4") return 16;
    accessor.refuse("type " + in_quotes(type) + " is not one that is used here");
}

template <class T>
T value_at(const std::byte* p) {
    T value;
    std::memcpy(&value, p, sizeof value);
    return value;
}

/// From -1 or 0 to 1 where normalised. [glTF2, 3.6.2.2]
template <class T>
float share_at(const std::byte* p, bool normalized) {
    const float v = value_at<T>(p);
    return normalized ? std::max(v / static_cast<float>(std::numeric_limits<T>::max()), -1.0f) : v;
}

float float_at(const std::byte* p, Component component, bool normalized) {
    switch (component) {
        case Component::int8:
            return share_at<std::int8_t>(p, normalized);
        case Component::uint8:
            return share_at<std::uint8_t>(p, normalized);
        case Component::int16:
            return share_at<std::int16_t>(p, normalized);
        case Component::uint16:
            return share_at<std::uint16_t>(p, normalized);
        case Component::uint32:
            return static_cast<float>(value_at<std::uint32_t>(p));
        default:
            return value_at<float>(p);
    }
}

std::uint32_t integer_at(const std::byte* p, Component component) {
    switch (component) {
        case Component::uint8:
            return value_at<std::uint8_t>(p);
        case Component::uint16:
            return value_at<std::uint16_t>(p);
        default:
            return value_at<std::uint32_t>(p);
    }
}

/// Consecutive elements of a buffer.
struct Run {
    const std::byte* first = nullptr;
    std::size_t stride = 0;
};

/// `count` elements of `size` bytes at `offset` in a view, all of which the view must hold.
Run run_in(const Document::Bytes& view, std::size_t offset, std::size_t count, std::size_t size,
           const Element& accessor) {
    const std::size_t stride = view.stride != 0 ? view.stride : size;
    if (stride < size)
        accessor.refuse("its elements of " + std::to_string(size) + " bytes overlap at a stride of " +
                        std::to_string(stride));
    const bool fits =
        offset <= view.size && size <= view.size - offset && (count - 1) <= (view.size - offset - size) / stride;
    if (!fits)
        accessor.refuse("asks for " + core::counted(count, "element") + " of " + std::to_string(size) +
                        " bytes from offset " + std::to_string(offset) + ", but its buffer view has " +
                        std::to_string(view.size) + " bytes");
    return {view.first + offset, stride};
}

/// An accessor's properties, checked against its user's needs.
struct Shape {
    std::size_t count = 0;
    int components = 1;
    Component component = Component::float32;
    bool normalized = false;
    std::optional<Run> run;  ///< none: zeros

    std::size_t element_size() const { return static_cast<std::size_t>(components) * size_of(component); }
};

Shape shape_of(const Document& document, const Element& accessor, std::size_t expected_count) {
    Shape shape;
    shape.count = accessor.required_size("count");
    shape.component = component_of(accessor);
    shape.components = components_of(accessor);
    shape.normalized = accessor.boolean("normalized", false);
    if (shape.count == 0) accessor.refuse("has no elements");
    if (expected_count != 0 && shape.count != expected_count)
        accessor.refuse("has " + core::counted(shape.count, "element") + " where " + std::to_string(expected_count) +
                        " are needed");
    if (shape.normalized && (shape.component == Component::float32 || shape.component == Component::uint32))
        accessor.refuse("is normalised, which its component type cannot be");

    const int view = accessor.index("bufferView", "bufferViews");
    if (view >= 0) {
        shape.run = run_in(document.view(view, accessor.where()), accessor.size("byteOffset", 0), shape.count,
                           shape.element_size(), accessor);
        return shape;
    }
    // Zeros take no room in the file. chosen: 2^20 elements, 12 MB; larger counts are known otherwise or have a buffer.
    constexpr std::size_t most_zeros = std::size_t{1} << 20;
    if (expected_count == 0 && shape.count > most_zeros)
        accessor.refuse("has " + core::counted(shape.count, "element") + " without a buffer view; at most " +
                        std::to_string(most_zeros) + " are read");
    return shape;
}

/// Calls take(index, bytes of the value) for each element, and again for each that a sparse accessor replaces. [glTF2,
/// 3.6.2.3]
template <class Take>
void for_each(const Document& document, const Element& accessor, const Shape& shape, Take take) {
    for (std::size_t i = 0; shape.run && i < shape.count; ++i) take(i, shape.run->first + i * shape.run->stride);
    const std::optional<Element> sparse = accessor.object("sparse");
    if (!sparse) return;
    const std::size_t count = sparse->required_size("count");
    if (count == 0 || count > shape.count)
        sparse->refuse("replaces " + core::counted(count, "element") + " of " + std::to_string(shape.count));
    const std::optional<Element> indices = sparse->object("indices"), values = sparse->object("values");
    if (!indices || !values) sparse->refuse("lacks indices or values");
    const Component component = component_of(*indices);
    if (component != Component::uint8 && component != Component::uint16 && component != Component::uint32)
        indices->refuse("componentType is not an unsigned integer");
    const Document::Bytes index_view =
        document.view(indices->required_index("bufferView", "bufferViews"), indices->where());
    const Document::Bytes value_view =
        document.view(values->required_index("bufferView", "bufferViews"), values->where());
    const Run index_run = run_in(index_view, indices->size("byteOffset", 0), count, size_of(component), *indices);
    const Run value_run = run_in(value_view, values->size("byteOffset", 0), count, shape.element_size(), *values);
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t index = integer_at(index_run.first + i * index_run.stride, component);
        if (index >= shape.count)
            indices->refuse("index " + std::to_string(index) + " exceeds the " + core::counted(shape.count, "element"));
        take(static_cast<std::size_t>(index), value_run.first + i * value_run.stride);
    }
}

Element named(const Document& document, int accessor, const std::string& user) {
    const Element element = document.at("accessors", accessor);
    return user.empty() ? element : element.seen_from(user);
}

}  // namespace

Floats read_floats(const Document& document, int accessor, std::initializer_list<int> components,
                   std::size_t expected_count, const std::string& user) {
    const Element element = named(document, accessor, user);
    const Shape shape = shape_of(document, element, expected_count);
    if (std::find(components.begin(), components.end(), shape.components) == components.end())
        element.refuse("is of type " + in_quotes(element.string("type", "")) + ", which does not fit here");

    Floats result;
    result.components = shape.components;
    const std::size_t n = static_cast<std::size_t>(shape.components), size = size_of(shape.component);
    result.values.assign(shape.count * n, 0.0f);
    const auto convert = [&](std::size_t index, const std::byte* bytes) {
        for (std::size_t k = 0; k < n; ++k)
            result.values[index * n + k] = float_at(bytes + k * size, shape.component, shape.normalized);
    };
    for_each(document, element, shape, convert);
    return result;
}

Floats read_finite_floats(const Document& document, int accessor, std::initializer_list<int> components,
                          std::size_t expected_count, const std::string& user) {
    Floats result = read_floats(document, accessor, components, expected_count, user);
    for (std::size_t i = 0; i < result.values.size(); ++i)
        if (!std::isfinite(result.values[i]))
            named(document, accessor, user)
                .refuse("element " + std::to_string(i / static_cast<std::size_t>(result.components)) +
                        " is not finite");
    return result;
}

std::vector<std::uint32_t> read_integers(const Document& document, int accessor, int components,
                                         std::size_t expected_count, const std::string& user) {
    const Element element = named(document, accessor, user);
    const Shape shape = shape_of(document, element, expected_count);
    if (shape.components != components)
        element.refuse("is of type " + in_quotes(element.string("type", "")) + ", which does not fit here");
    const bool is_unsigned = shape.component == Component::uint8 || shape.component == Component::uint16 ||
                             shape.component == Component::uint32;
    if (!is_unsigned || shape.normalized) element.refuse("must hold unsigned integers");

    std::vector<std::uint32_t> result;
    const std::size_t n = static_cast<std::size_t>(components), size = size_of(shape.component);
    result.assign(shape.count * n, 0);
    const auto convert = [&](std::size_t index, const std::byte* bytes) {
        for (std::size_t k = 0; k < n; ++k) result[index * n + k] = integer_at(bytes + k * size, shape.component);
    };
    for_each(document, element, shape, convert);
    return result;
}

}  // namespace render2mpeg::scene::gltf
