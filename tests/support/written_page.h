#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/support/places.h"

/// Pages that tests make: kept ones, which they compare, and others in the build's folder `docs`.
namespace render2mpeg::support {

/// Whether pages are to be written instead of compared: the environment has RENDER2MPEG_WRITE_PAGES.
inline bool writes_pages() {
    return std::getenv("RENDER2MPEG_WRITE_PAGES") != nullptr;
}

/// Writes a page that is not kept to the build's folder `docs`.
inline void write_page(const std::string& name, const std::string& text) {
    const auto folder = binary_folder() / "docs";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / name, std::ios::binary) << text;
}

/// Expects a file of this tree to hold `text`, or writes it there.
inline void expect_page(const std::string& path, const std::string& text) {
    const auto file = source_folder() / path;
    if (writes_pages()) {
        std::ofstream(file, std::ios::binary) << text;
        return;
    }
    std::ifstream stream(file, std::ios::binary);
    const std::string committed(std::istreambuf_iterator<char>(stream), {});
    if (committed == text) return;
    const auto differ = std::mismatch(committed.begin(), committed.end(), text.begin(), text.end());
    const auto line_of = [](const std::string& whole, std::string::const_iterator at) {
        const std::size_t offset = static_cast<std::size_t>(at - whole.begin());
        const std::size_t begin = offset == 0 ? 0 : whole.rfind('\n', offset - 1) + 1;
        return whole.substr(begin, std::min(whole.find('\n', offset), whole.size()) - begin);
    };
    ADD_FAILURE() << path << " is not what is found now. The first line that differs:\n  "
                  << line_of(committed, differ.first) << "\n  " << line_of(text, differ.second)
                  << "\nRun this test with RENDER2MPEG_WRITE_PAGES=1 to write the page anew.";
}

}  // namespace render2mpeg::support
