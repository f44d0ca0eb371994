#pragma once

#include <string>
#include <vector>

/// Hard cases that are proven elsewhere: in which test, or by which of the scenes here.
namespace render2mpeg::test {

struct Proof {
    std::string name;
    std::string outcome;
    std::vector<std::string> cases;  ///< HardCase::name
    std::vector<std::string> tests;  ///< "Suite.Name" of a test somewhere in tests/
};

/// What goes wrong in light, geometry and time: one by one.
std::vector<Proof> numeric_proofs();
/// Files that are broken or hostile, and runs that are.
std::vector<Proof> file_proofs();
/// Pictures, motion and rates that are hard to code.
std::vector<Proof> coding_proofs();

}  // namespace render2mpeg::test
