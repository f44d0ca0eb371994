#include "core/isa.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>
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

/// RENDER2MPEG_ISA while this lives.
class HighestIsa {
  public:
    explicit HighestIsa(const char* name) {
        if (const char* before = std::getenv(variable)) before_ = before;
        setenv(variable, name, 1);
    }
    ~HighestIsa() { before_ ? setenv(variable, before_->c_str(), 1) : unsetenv(variable); }
    HighestIsa(const HighestIsa&) = delete;
    HighestIsa& operator=(const HighestIsa&) = delete;

  private:
    static constexpr const char* variable = "RENDER2MPEG_ISA";
    std::optional<std::string> before_;
};

TEST(Isa, ThatIsNamedAsHighestMakesTheProcessorOneWithoutThoseAbove) {
    const Isa highest = detect_isa();
    for (const Isa isa : all) {
        if (isa > highest) break;
        const HighestIsa named(name_of(isa));
        EXPECT_EQ(detect_isa(), isa);
        for (const Isa other : all) {
            if (other <= isa)
                EXPECT_EQ(isa_from(name_of(other)), other);
            else
                EXPECT_THROW(isa_from(name_of(other)), Error);
        }
    }
    for (const char* name : {"mmx", "AVX2"}) {
        const HighestIsa named(name);
        EXPECT_THROW(detect_isa(), Error) << name;
    }
    const HighestIsa none("");
    EXPECT_GE(detect_isa(), highest);
}

TEST(Isa, NamesAreDistinct) {
    for (const Isa a : all)
        for (const Isa b : all) EXPECT_EQ(std::string(name_of(a)) == name_of(b), a == b);
}

}  // namespace
}  // namespace render2mpeg::core
