#include "core/error.h"

#include <gtest/gtest.h>

#include <string>

namespace render2mpeg::core {
namespace {

TEST(Error, IsOneLineThatNamesFileAndCause) {
    EXPECT_STREQ(Error("reading", "a/b.gltf", "no such file").what(), "reading a/b.gltf: no such file");
}

TEST(Error, NamesTheObjectBetweenFileAndCause) {
    EXPECT_STREQ(Error("reading", "b.glb", "mesh \"Chair\", primitive 2", "index 9 of 3 vertices").what(),
                 "reading b.glb: mesh \"Chair\", primitive 2: index 9 of 3 vertices");
}

TEST(Error, WithoutFileIsTheLineItWasGiven) {
    EXPECT_STREQ(Error("size 0x0: too small").what(), "size 0x0: too small");
}

TEST(Contract, ThatHoldsDoesNothing) {
    EXPECT_NO_THROW(EXPECTS(1 + 1 == 2));
}

TEST(Contract, ThatIsBrokenSaysConditionFileAndLine) {
    const int wheels = 3;
    try {
        EXPECTS(wheels == 4);
        FAIL() << "the contract was not checked";
    } catch (const ContractViolation& violation) {
        const std::string line = violation.what();
        EXPECT_NE(line.find("wheels == 4"), std::string::npos) << line;
        EXPECT_NE(line.find("error_test.cpp:"), std::string::npos) << line;
    }
}

TEST(Contract, IsNoErrorOfTheUser) {
    // main prints an Error and returns 1, but a ContractViolation is a defect: one must not be caught as the other.
    EXPECT_FALSE((std::is_base_of_v<Error, ContractViolation>));
    EXPECT_FALSE((std::is_base_of_v<std::runtime_error, ContractViolation>));
}

TEST(Contract, EvaluatesItsConditionOnce) {
    int calls = 0;
    EXPECTS(++calls == 1);
    EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace render2mpeg::core
