#include "encoder/mpeg2/bitstream/codes.h"

#include <span>

namespace render2mpeg::encoder::mpeg2 {

const std::array<Code, 34> address_increment_codes = {{
    {0x8, 11},  {0x1, 1},   {0x3, 3},   {0x2, 3},   {0x3, 4},   {0x2, 4},   {0x3, 5},   {0x2, 5},   {0x7, 7},
    {0x6, 7},   {0xb, 8},   {0xa, 8},   {0x9, 8},   {0x8, 8},   {0x7, 8},   {0x6, 8},   {0x17, 10}, {0x16, 10},
    {0x15, 10}, {0x14, 10}, {0x13, 10}, {0x12, 10}, {0x23, 11}, {0x22, 11}, {0x21, 11}, {0x20, 11}, {0x1f, 11},
    {0x1e, 11}, {0x1d, 11}, {0x1c, 11}, {0x1b, 11}, {0x1a, 11}, {0x19, 11}, {0x18, 11},
}};

const std::array<Code, 64> pattern_codes = {{
    {0x1, 9},  {0xb, 5},  {0x9, 5},  {0xd, 6},  {0xd, 4},  {0x17, 7}, {0x13, 7}, {0x1f, 8}, {0xc, 4},  {0x16, 7},
    {0x12, 7}, {0x1e, 8}, {0x13, 5}, {0x1b, 8}, {0x17, 8}, {0x13, 8}, {0xb, 4},  {0x15, 7}, {0x11, 7}, {0x1d, 8},
    {0x11, 5}, {0x19, 8}, {0x15, 8}, {0x11, 8}, {0xf, 6},  {0xf, 8},  {0xd, 8},  {0x3, 9},  {0xf, 5},  {0xb, 8},
    {0x7, 8},  {0x7, 9},  {0xa, 4},  {0x14, 7}, {0x10, 7}, {0x1c, 8}, {0xe, 6},  {0xe, 8},  {0xc, 8},  {0x2, 9},
    {0x10, 5}, {0x18, 8}, {0x14, 8}, {0x10, 8}, {0xe, 5},  {0xa, 8},  {0x6, 8},  {0x6, 9},  {0x12, 5}, {0x1a, 8},
    {0x16, 8}, {0x12, 8}, {0xd, 5},  {0x9, 8},  {0x5, 8},  {0x5, 9},  {0xc, 5},  {0x8, 8},  {0x4, 8},  {0x4, 9},
    {0x7, 3},  {0xa, 5},  {0x8, 5},  {0xc, 6},
}};

const std::array<Code, 17> motion_codes = {{{0x1, 1},
                                            {0x1, 2},
                                            {0x1, 3},
                                            {0x1, 4},
                                            {0x3, 6},
                                            {0x5, 7},
                                            {0x4, 7},
                                            {0x3, 7},
                                            {0xb, 9},
                                            {0xa, 9},
                                            {0x9, 9},
                                            {0x11, 10},
                                            {0x10, 10},
                                            {0xf, 10},
                                            {0xe, 10},
                                            {0xd, 10},
                                            {0xc, 10}}};

const std::array<Code, 12> luma_dc_size_codes = {{{0x4, 3},
                                                  {0x0, 2},
                                                  {0x1, 2},
                                                  {0x5, 3},
                                                  {0x6, 3},
                                                  {0xe, 4},
                                                  {0x1e, 5},
                                                  {0x3e, 6},
                                                  {0x7e, 7},
                                                  {0xfe, 8},
                                                  {0x1fe, 9},
                                                  {0x1ff, 9}}};

const std::array<Code, 12> chroma_dc_size_codes = {{{0x0, 2},
                                                    {0x1, 2},
                                                    {0x2, 2},
                                                    {0x6, 3},
                                                    {0xe, 4},
                                                    {0x1e, 5},
                                                    {0x3e, 6},
                                                    {0x7e, 7},
                                                    {0xfe, 8},
                                                    {0x1fe, 9},
                                                    {0x3fe, 10},
                                                    {0x3ff, 10}}};

namespace {

struct Row {
    std::uint8_t run, level;
    std::uint16_t bits;
    std::uint8_t length;
};

// Table B-14 whole.
constexpr Row rows_zero[] = {
    {0, 1, 0x3, 2},    {0, 2, 0x4, 4},    {0, 3, 0x5, 5},    {0, 4, 0x6, 7},    {0, 5, 0x26, 8},   {0, 6, 0x21, 8},
    {0, 7, 0xa, 10},   {0, 8, 0x1d, 12},  {0, 9, 0x18, 12},  {0, 10, 0x13, 12}, {0, 11, 0x10, 12}, {0, 12, 0x1a, 13},
    {0, 13, 0x19, 13}, {0, 14, 0x18, 13}, {0, 15, 0x17, 13}, {0, 16, 0x1f, 14}, {0, 17, 0x1e, 14}, {0, 18, 0x1d, 14},
    {0, 19, 0x1c, 14}, {0, 20, 0x1b, 14}, {0, 21, 0x1a, 14}, {0, 22, 0x19, 14}, {0, 23, 0x18, 14}, {0, 24, 0x17, 14},
    {0, 25, 0x16, 14}, {0, 26, 0x15, 14}, {0, 27, 0x14, 14}, {0, 28, 0x13, 14}, {0, 29, 0x12, 14}, {0, 30, 0x11, 14},
    {0, 31, 0x10, 14}, {0, 32, 0x18, 15}, {0, 33, 0x17, 15}, {0, 34, 0x16, 15}, {0, 35, 0x15, 15}, {0, 36, 0x14, 15},
    {0, 37, 0x13, 15}, {0, 38, 0x12, 15}, {0, 39, 0x11, 15}, {0, 40, 0x10, 15}, {1, 1, 0x3, 3},    {1, 2, 0x6, 6},
    {1, 3, 0x25, 8},   {1, 4, 0xc, 10},   {1, 5, 0x1b, 12},  {1, 6, 0x16, 13},  {1, 7, 0x15, 13},  {1, 8, 0x1f, 15},
    {1, 9, 0x1e, 15},  {1, 10, 0x1d, 15}, {1, 11, 0x1c, 15}, {1, 12, 0x1b, 15}, {1, 13, 0x1a, 15}, {1, 14, 0x19, 15},
    {1, 15, 0x13, 16}, {1, 16, 0x12, 16}, {1, 17, 0x11, 16}, {1, 18, 0x10, 16}, {2, 1, 0x5, 4},    {2, 2, 0x4, 7},
    {2, 3, 0xb, 10},   {2, 4, 0x14, 12},  {2, 5, 0x14, 13},  {3, 1, 0x7, 5},    {3, 2, 0x24, 8},   {3, 3, 0x1c, 12},
    {3, 4, 0x13, 13},  {4, 1, 0x6, 5},    {4, 2, 0xf, 10},   {4, 3, 0x12, 12},  {5, 1, 0x7, 6},    {5, 2, 0x9, 10},
    {5, 3, 0x12, 13},  {6, 1, 0x5, 6},    {6, 2, 0x1e, 12},  {6, 3, 0x14, 16},  {7, 1, 0x4, 6},    {7, 2, 0x15, 12},
    {8, 1, 0x7, 7},    {8, 2, 0x11, 12},  {9, 1, 0x5, 7},    {9, 2, 0x11, 13},  {10, 1, 0x27, 8},  {10, 2, 0x10, 13},
    {11, 1, 0x23, 8},  {11, 2, 0x1a, 16}, {12, 1, 0x22, 8},  {12, 2, 0x19, 16}, {13, 1, 0x20, 8},  {13, 2, 0x18, 16},
    {14, 1, 0xe, 10},  {14, 2, 0x17, 16}, {15, 1, 0xd, 10},  {15, 2, 0x16, 16}, {16, 1, 0x8, 10},  {16, 2, 0x15, 16},
    {17, 1, 0x1f, 12}, {18, 1, 0x1a, 12}, {19, 1, 0x19, 12}, {20, 1, 0x17, 12}, {21, 1, 0x16, 12}, {22, 1, 0x1f, 13},
    {23, 1, 0x1e, 13}, {24, 1, 0x1d, 13}, {25, 1, 0x1c, 13}, {26, 1, 0x1b, 13}, {27, 1, 0x1f, 16}, {28, 1, 0x1e, 16},
    {29, 1, 0x1d, 16}, {30, 1, 0x1c, 16}, {31, 1, 0x1b, 16},
};

// Table B-15 where it differs from B-14.
constexpr Row rows_one[] = {
    {0, 1, 0x2, 2},   {0, 2, 0x6, 3},   {0, 3, 0x7, 4},   {0, 4, 0x1c, 5},  {0, 5, 0x1d, 5},  {0, 6, 0x5, 6},
    {0, 7, 0x4, 6},   {0, 8, 0x7b, 7},  {0, 9, 0x7c, 7},  {0, 10, 0x23, 8}, {0, 11, 0x22, 8}, {0, 12, 0xfa, 8},
    {0, 13, 0xfb, 8}, {0, 14, 0xfe, 8}, {0, 15, 0xff, 8}, {1, 1, 0x2, 3},   {1, 2, 0x6, 5},   {1, 3, 0x79, 7},
    {1, 4, 0x27, 8},  {1, 5, 0x20, 8},  {2, 1, 0x5, 5},   {2, 2, 0x7, 7},   {2, 3, 0xfc, 8},  {2, 4, 0xc, 10},
    {3, 1, 0x7, 5},   {3, 2, 0x26, 8},  {4, 1, 0x6, 6},   {4, 2, 0xfd, 8},  {5, 1, 0x7, 6},   {5, 2, 0x4, 9},
    {6, 1, 0x6, 7},   {7, 1, 0x4, 7},   {8, 1, 0x5, 7},   {9, 1, 0x78, 7},  {10, 1, 0x7a, 7}, {11, 1, 0x21, 8},
    {12, 1, 0x25, 8}, {13, 1, 0x24, 8}, {14, 1, 0x5, 9},  {15, 1, 0x7, 9},  {16, 1, 0xd, 10},
};

void enter(CoefficientCodes& codes, std::span<const Row> rows) {
    for (const Row& row : rows) codes.code[row.run][row.level] = {row.bits, row.length};
}

}  // namespace

const CoefficientCodes& coefficient_codes_zero() {
    static const CoefficientCodes codes = [] {
        CoefficientCodes c;
        enter(c, rows_zero);
        c.end_of_block = {0b10, 2};
        return c;
    }();
    return codes;
}

const CoefficientCodes& coefficient_codes_one() {
    static const CoefficientCodes codes = [] {
        CoefficientCodes c;
        enter(c, rows_zero);
        enter(c, rows_one);
        c.end_of_block = {0b0110, 4};
        return c;
    }();
    return codes;
}

namespace {

/// Table B-4; quant and no motion are settled.
Code bidirectional_type_code(const MacroblockType& type) {
    const std::uint32_t coded = type.pattern ? 1 : 0;
    if (type.motion_forward && type.motion_backward) return type.quant ? Code{0b00010, 5} : Code{0b10 | coded, 2};
    if (type.motion_backward) return type.quant ? Code{0b000010, 6} : Code{0b010 | coded, 3};
    return type.quant ? Code{0b000011, 6} : Code{0b0010 | coded, 4};
}

}  // namespace

Code macroblock_type_code(PictureType picture, const MacroblockType& type) {
    if (picture == PictureType::intra) {
        if (!type.intra) return {};
        return type.quant ? Code{0b01, 2} : Code{0b1, 1};
    }
    if (picture == PictureType::bidirectional && !type.intra) {
        const bool none = (!type.motion_forward && !type.motion_backward) || (type.quant && !type.pattern);
        return none ? Code{} : bidirectional_type_code(type);
    }
    if (type.motion_backward) return {};
    if (type.intra) return type.quant ? Code{0b000001, 6} : Code{0b00011, 5};
    if (!type.pattern) return type.motion_forward && !type.quant ? Code{0b001, 3} : Code{};
    if (type.motion_forward) return type.quant ? Code{0b00010, 5} : Code{0b1, 1};
    return type.quant ? Code{0b00001, 5} : Code{0b01, 2};
}

}  // namespace render2mpeg::encoder::mpeg2
