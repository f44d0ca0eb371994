#include "image/module/exr_zip.h"

#include <immintrin.h>
#include <libdeflate.h>

#include <cstddef>
#include <new>

namespace render2mpeg::image {
namespace {

/// Each byte of a packed chunk is the difference to the one before, plus 128. [OpenEXRFile]
void undo_differences(std::span<std::uint8_t> bytes) {
    // Sixteen at a time: after sums over 1, 2, 4 and 8 neighbours each byte has those of all before it.
    const __m128i bias = _mm_set1_epi8(-128);
    __m128i sum = bias;
    std::size_t i = 0;
    for (; i + 16 <= bytes.size(); i += 16) {
        auto* at = reinterpret_cast<__m128i*>(bytes.data() + i);
        __m128i v = _mm_add_epi8(_mm_loadu_si128(at), bias);
        v = _mm_add_epi8(v, _mm_slli_si128(v, 1));
        v = _mm_add_epi8(v, _mm_slli_si128(v, 2));
        v = _mm_add_epi8(v, _mm_slli_si128(v, 4));
        v = _mm_add_epi8(v, _mm_slli_si128(v, 8));
        v = _mm_add_epi8(v, sum);
        _mm_storeu_si128(at, v);
        sum = _mm_set1_epi8(static_cast<char>(bytes[i + 15]));
    }
    auto last = static_cast<std::uint8_t>(i > 0 ? bytes[i - 1] : 128);
    for (; i < bytes.size(); ++i) bytes[i] = last = static_cast<std::uint8_t>(last + bytes[i] - 128);
}

}  // namespace

ZipUnpacker::ZipUnpacker() : inflate_(libdeflate_alloc_decompressor(), &libdeflate_free_decompressor) {
    if (!inflate_) throw std::bad_alloc();
}

bool ZipUnpacker::unpack(std::span<const char> packed, std::span<std::uint8_t> bytes) {
    if (libdeflate_zlib_decompress(inflate_.get(), packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr) !=
        LIBDEFLATE_SUCCESS)
        return false;
    undo_differences(bytes);
    return true;
}

}  // namespace render2mpeg::image
