#include "core/isa.h"

#include <gtest/gtest.h>

#include <string>

#include "core/error.h"

namespace render2mpeg::core {
namespace {

constexpr Isa all[] = {Isa::sse2, Isa::sse4_2, Isa::avx, Isa::avx2, Isa::avx512};

TEST(Isa, UpToThisProcessorsIsFoundByItsName) {
    for (const Isa isa : all) {
        if (isa > detect_isa()) break;
        EXPECT_EQ(isa_from(name_of(isa)), isa);
    }
}

TEST(Isa, AboveThisProcessorsIsRefusedByNamingTheHighest) {
    for (const Isa isa : all) {
        if (isa <= detect_isa()) continue;
        try {
            isa_from(name_of(isa));
            FAIL() << "accepted " << name_of(isa);
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(name_of(detect_isa())), std::string::npos) << error.what();
        }
    }
}

TEST(Isa, ThatDoesNotExistIsRefusedWithTheList) {
    for (const char* name : {"", "mmx", "AVX2", "avx2 "}) {
        try {
            isa_from(name);
            FAIL() << "accepted " << name;
        } catch (const Error& error) {
            for (const Isa isa : all)
                EXPECT_NE(std::string(error.what()).find(name_of(isa)), std::string::npos) << error.what();
        }
    }
}

TEST(Isa, NamesAreDistinct) {
    for (const Isa a : all)
        for (const Isa b : all) EXPECT_EQ(std::string(name_of(a)) == name_of(b), a == b);
}

}  // namespace
}  // namespace render2mpeg::core
