#include "fuzz/mutation.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "core/sampling.h"

namespace render2mpeg::fuzz {
namespace {

constexpr std::size_t longest = 1 << 16;

/// Numbers on which careless code fails.
constexpr std::array<std::uint32_t, 14> words{0,          1,          0x7f,       0x80,       0xff,
                                              0xffff,     0x7fffffff, 0x80000000, 0xffffffff, 0x7fc00000,
                                              0x7f800000, 0xff800000, 0x00000001, 0x7f7fffff};
constexpr std::array<std::string_view, 14> numbers{"0",          "-1",         "1e38",       "-1e39", "1e-40",
                                                   "4294967295", "4294967296", "2147483648", "65536", "0.5",
                                                   "1e999",      "null",       "\"\"",       "[]"};

class Mutation {
  public:
    Mutation(std::span<const Bytes> corpus, std::uint64_t seed, std::uint64_t number)
        : corpus_(corpus), seed_(seed), number_(number), bytes_(corpus[pick(corpus.size())]) {}

    Bytes result() {
        // Few changes most of the time: many leave nothing whole.
        for (std::size_t left = 1 + pick(1 + pick(8)); left > 0; --left) change();
        if (bytes_.size() > longest) bytes_.resize(longest);
        return std::move(bytes_);
    }

  private:
    std::size_t pick(std::size_t count) {
        const double u = core::uniform(seed_, number_, drawn_++, 0);
        return std::min(static_cast<std::size_t>(u * static_cast<double>(count)), count - 1);
    }
    std::ptrdiff_t place() { return static_cast<std::ptrdiff_t>(pick(bytes_.size() + 1)); }
    /// A piece of `of`: seldom a long one.
    std::span<const std::uint8_t> piece(const Bytes& of) {
        if (of.empty()) return {};
        const std::size_t first = pick(of.size()), most = of.size() - first;
        return std::span(of).subspan(first, 1 + pick(std::min<std::size_t>(most, pick(4) == 0 ? most : 16)));
    }

    void insert(std::span<const std::uint8_t> what) {
        const Bytes copy(what.begin(), what.end());  // it may be a part of what it goes into
        bytes_.insert(bytes_.begin() + place(), copy.begin(), copy.end());
    }
    void cut() {
        const auto gone = piece(bytes_);
        const auto first = bytes_.begin() + (gone.data() - bytes_.data());
        bytes_.erase(first, first + static_cast<std::ptrdiff_t>(gone.size()));
    }
    void put_word() {
        const std::uint32_t word = words[pick(words.size())];
        const std::size_t size = std::size_t{1} << pick(3), at = pick(bytes_.size());
        const bool big = pick(2) == 0;
        for (std::size_t k = 0; k < size && at + k < bytes_.size(); ++k)
            bytes_[at + k] = static_cast<std::uint8_t>(word >> (8 * (big ? size - 1 - k : k)));
    }
    /// Another number in place of one that is written out.
    void put_digits() {
        const auto is_digit = [](std::uint8_t c) { return c >= '0' && c <= '9'; };
        const auto first = std::find_if(bytes_.begin() + place(), bytes_.end(), is_digit);
        const auto last =
            std::find_if_not(first, bytes_.end(), [&](std::uint8_t c) { return is_digit(c) || c == '.'; });
        const std::string_view text = numbers[pick(numbers.size())];
        const auto at = bytes_.erase(first, last);
        bytes_.insert(at, text.begin(), text.end());
    }

    void change() {
        if (bytes_.empty()) return insert(piece(corpus_[pick(corpus_.size())]));
        switch (pick(8)) {
            case 0:
                bytes_[pick(bytes_.size())] ^= static_cast<std::uint8_t>(1u << pick(8));
                break;
            case 1:
                bytes_[pick(bytes_.size())] = static_cast<std::uint8_t>(pick(256));
                break;
            case 2:
                put_word();
                break;
            case 3:
                cut();
                break;
            case 4:
                insert(piece(bytes_));
                break;
            case 5:
                insert(piece(corpus_[pick(corpus_.size())]));
                break;
            default:
                put_digits();
        }
    }

    std::span<const Bytes> corpus_;
    std::uint64_t seed_, number_, drawn_ = 0;
    Bytes bytes_;
};

}  // namespace

Bytes mutated(std::span<const Bytes> corpus, std::uint64_t seed, std::uint64_t number) {
    return Mutation(corpus, seed, number).result();
}

}  // namespace render2mpeg::fuzz
