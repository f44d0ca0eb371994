#pragma once

#include <unistd.h>

#include <bit>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "fuzz/targets.h"

namespace render2mpeg::fuzz {

/// A file with an input in it, the same one each time; its folder goes with the process unless that crashes, so that
/// what crashed it is still there.
class InputFile {
  public:
    InputFile() {
        std::string pattern = (std::filesystem::temp_directory_path() / "render2mpeg-fuzz.XXXXXX").string();
        if (mkdtemp(pattern.data()) != nullptr) folder_ = pattern;
    }
    ~InputFile() {
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;

    std::filesystem::path write(const std::string& name, Input input) const {
        std::ofstream(folder_ / name, std::ios::binary)
            .write(reinterpret_cast<const char*>(input.data()), static_cast<std::streamsize>(input.size()));
        return folder_ / name;
    }

  private:
    std::filesystem::path folder_;
};

inline const InputFile& input_file() {
    static const InputFile file;
    return file;
}

/// An input as numbers, one after the other; 0 once it is used up.
class Numbers {
  public:
    explicit Numbers(Input input) : input_(input) {}
    bool left() const { return at_ < input_.size(); }
    std::uint32_t byte() { return left() ? input_[at_++] : 0; }
    std::uint32_t word() {
        std::uint32_t value = 0;
        for (int k = 0; k < 4; ++k) value = value << 8 | byte();
        return value;
    }
    /// Any bits: infinite and no number at all, too.
    float any_float() { return std::bit_cast<float>(word()); }
    int pick(int low, int high) { return low + static_cast<int>(byte() % static_cast<std::uint32_t>(high - low + 1)); }

  private:
    Input input_;
    std::size_t at_ = 0;
};

}  // namespace render2mpeg::fuzz
