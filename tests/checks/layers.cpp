#include "checks/layers.h"

#include <algorithm>
#include <initializer_list>
#include <map>
#include <set>
#include <string>
#include <string_view>

namespace render2mpeg::checks {
namespace {

/// A part of the product, where it lies, how its headers are spelled, and which parts beside itself it may include.
struct Part {
    std::string_view name;
    std::string_view folder;
    std::vector<std::string_view> may_include;
};

const std::vector<Part>& parts() {
    static const std::vector<Part> all = {
        {"core", "src/core/", {}},
        {"parallel", "src/parallel/", {"core"}},
        {"image", "src/image/", {"core"}},
        {"scene", "src/scene/", {"core"}},
        {"renderer", "src/renderer/", {"core", "scene", "image", "parallel"}},
        {"perceptual", "perceptual/", {"core"}},
        {"encoder", "encoder/", {"core", "parallel"}},
        {"app", "src/app/", {"core", "parallel", "image", "scene", "renderer", "perceptual", "encoder"}},
    };
    return all;
}

/// An outside library, how its headers begin, the one folder of the product that may know it, and in how many files.
struct Library {
    std::string_view name;
    std::vector<std::string_view> headers;
    std::string_view folder;  ///< empty: any
    std::size_t most_files;
};

constexpr std::size_t any_number = ~std::size_t{0};

const std::vector<Library>& libraries() {
    static const std::vector<Library> all = {
        {"Embree", {"embree3/", "embree4/"}, "src/renderer/geometry/", 1},
        {"OpenImageIO", {"OpenImageIO/"}, "src/image/", 2},
        {"OpenEXR", {"OpenEXR/", "Imath/", "Imf", "half.h"}, "src/image/", 2},
        {"libdeflate", {"libdeflate.h"}, "src/image/", 1},
        {"libpng", {"png.h"}, "src/image/", 1},
        {"libjpeg", {"jpeglib.h"}, "src/image/", 1},
        {"FFmpeg", {"libav", "libsw"}, "encoder/av/", 2},
        {"libebur128", {"ebur128.h"}, "encoder/av/", 1},
        {"TBB", {"tbb/", "oneapi/"}, "src/parallel/", 2},
        {"Assimp", {"assimp/"}, "src/scene/assimp/", 3},
        {"Draco", {"draco/"}, "src/scene/module/", 1},
        {"OpenVDB", {"openvdb/"}, "src/scene/module/", 1},
        {"meshoptimizer", {"meshoptimizer.h"}, "src/scene/gltf/", 1},
        {"kissfft", {"kiss_fft"}, "perceptual/", 1},
        {"CLI11", {"CLI/"}, "src/app/options/", 2},
        {"GLM", {"glm/"}, "", any_number},
        {"fmt", {"fmt/"}, "", any_number},
        {"nlohmann-json", {"nlohmann/"}, "", any_number},
        {"the processor's intrinsics", {"immintrin.h", "xmmintrin.h", "emmintrin.h"}, "", any_number},
        {"the C library's heap", {"malloc.h"}, "", 2},
        {"POSIX",
         {"unistd.h", "dlfcn.h", "elf.h", "fcntl.h", "link.h", "poll.h", "signal.h", "spawn.h", "sys/"},
         "",
         any_number},
    };
    return all;
}

const Part* part_of(const std::string& path) {
    for (const Part& part : parts())
        if (path.starts_with(part.folder)) return &part;
    return nullptr;
}

const Library* library_of(const std::string& header) {
    for (const Library& library : libraries())
        for (const std::string_view begin : library.headers)
            if (header.starts_with(begin)) return &library;
    return nullptr;
}

/// <vector>, <filesystem>: the standard's own headers have neither a folder nor an ending.
bool is_standard(const std::string& header) {
    return header.find_first_of("./") == std::string::npos;
}

/// What is wrong with one quoted include, or nothing.
std::string wrong_with_own(const Part& here, const Include& include) {
    const std::string first = include.name.substr(0, include.name.find('/'));
    const bool known =
        std::any_of(parts().begin(), parts().end(), [&](const Part& part) { return part.name == first; });
    if (!known || first.size() == include.name.size())
        return "\"" + include.name + "\" is not spelled from an include root, such as \"core/plane.h\"";
    const auto& allowed = here.may_include;
    if (first == here.name || std::find(allowed.begin(), allowed.end(), first) != allowed.end()) return {};
    return std::string(here.name) + " may not know " + first + ", but includes \"" + include.name + "\"";
}

std::string wrong_with_outside(const File& file, const Part& here, const Include& include, const Library* library) {
    if (is_standard(include.name)) return {};
    if (library == nullptr) return "<" + include.name + "> is of no library in the layer check's table";
    if (here.name == "core" && library->name != "GLM" && library->name != "POSIX")
        return "core may know no outside library but GLM, and includes <" + include.name + ">";
    if (!library->folder.empty() && !file.begins_with(library->folder))
        return std::string(library->name) + " belongs to " + std::string(library->folder) + " alone";
    return {};
}

}  // namespace

std::vector<Finding> layer_breaches(const std::vector<File>& files) {
    std::vector<Finding> findings;
    std::map<const Library*, std::set<std::string>> users;
    for (const File& file : files) {
        if (!file.is_product()) continue;
        const Part* part = part_of(file.path);
        if (part == nullptr) {
            findings.push_back({file.path, 0, "lies in no part of the product"});
            continue;
        }
        for (const Include& include : includes_of(file)) {
            const Library* library = include.quoted ? nullptr : library_of(include.name);
            const std::string wrong =
                include.quoted ? wrong_with_own(*part, include) : wrong_with_outside(file, *part, include, library);
            if (!wrong.empty()) findings.push_back({file.path, include.line, wrong});
            if (library != nullptr) users[library].insert(file.path);
        }
    }
    for (const Library& library : libraries()) {
        const auto& files_with_it = users[&library];
        if (files_with_it.size() <= library.most_files) continue;
        for (const std::string& path : files_with_it)
            findings.push_back({path, 0,
                                std::string(library.name) + " is included by " + std::to_string(files_with_it.size()) +
                                    " files, of at most " + std::to_string(library.most_files)});
    }
    return findings;
}

}  // namespace render2mpeg::checks
