#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "fuzz/mutation.h"
#include "fuzz/targets.h"
#include "tests/support/places.h"

/// What is in corpus/ and what comes of it by random changes, the same ones each time. By hand, for longer:
///   RENDER2MPEG_FUZZ_SECONDS=600 RENDER2MPEG_FUZZ_SEED=2 test_fuzz --gtest_filter='*/gltf'
/// RENDER2MPEG_FUZZ_KEEP=FILE keeps each input in a file before it is run, for what crashes.
namespace render2mpeg::fuzz {
namespace {

std::string setting(const char* name) {
    const char* value = std::getenv(name);
    return value == nullptr ? "" : value;
}

/// The inputs of a target, by name.
std::vector<Bytes> corpus_of(const std::string& name) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(support::source_folder() / "tests/fuzz/corpus" / name))
        files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    std::vector<Bytes> corpus;
    for (const std::filesystem::path& file : files) {
        std::ifstream stream(file, std::ios::binary);
        corpus.emplace_back(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
    }
    return corpus;
}

/// Runs an input and says how it ended. A finding leaves its input behind.
bool run(const NamedTarget& target, const Bytes& input, const std::string& what) {
    if (const std::string keep = setting("RENDER2MPEG_FUZZ_KEEP"); !keep.empty())
        std::ofstream(keep, std::ios::binary | std::ios::trunc)
            .write(reinterpret_cast<const char*>(input.data()), static_cast<std::streamsize>(input.size()));
    try {
        return target.run(input);
    } catch (const std::exception& error) {
        const std::string file = std::string("fuzz-") + target.name + ".input";
        std::ofstream(file, std::ios::binary)
            .write(reinterpret_cast<const char*>(input.data()), static_cast<std::streamsize>(input.size()));
        ADD_FAILURE() << target.name << ", " << what << " (" << file << "): " << error.what();
        return false;
    }
}

class Fuzz : public testing::TestWithParam<NamedTarget> {};

TEST_P(Fuzz, InputsOfStrangersEndWellOrAreRefused) {
    const NamedTarget& target = GetParam();
    const std::vector<Bytes> corpus = corpus_of(target.name);
    ASSERT_FALSE(corpus.empty());
    std::size_t taken = 0;
    for (std::size_t i = 0; i < corpus.size(); ++i)
        taken += run(target, corpus[i], "input " + std::to_string(i)) ? 1 : 0;
    EXPECT_GT(2 * taken, corpus.size()) << "most of what is in the corpus should be good";

    const std::string seconds = setting("RENDER2MPEG_FUZZ_SECONDS"), seed_text = setting("RENDER2MPEG_FUZZ_SEED");
    const std::uint64_t seed = seed_text.empty() ? 3 : std::stoull(seed_text);
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(seconds.empty() ? 0 : std::stol(seconds));
    std::size_t accepted = 0;
    std::uint64_t n = 0;
    for (; (seconds.empty() ? n < static_cast<std::uint64_t>(target.mutations)
                            : std::chrono::steady_clock::now() < end) &&
           !HasFailure();
         ++n)
        accepted +=
            run(target, mutated(corpus, seed, n), "change " + std::to_string(n) + " of seed " + std::to_string(seed))
                ? 1
                : 0;
    EXPECT_GT(accepted, 0u) << "changes that leave nothing whole try little";
    EXPECT_LT(accepted, n) << "and so do changes that break nothing";
    RecordProperty("accepted", std::to_string(accepted) + " of " + std::to_string(n));
    if (!seconds.empty())
        std::printf("%s: %llu inputs, %zu accepted\n", target.name, static_cast<unsigned long long>(n), accepted);
}

INSTANTIATE_TEST_SUITE_P(Door, Fuzz, testing::ValuesIn(targets().begin(), targets().end()),
                         [](const auto& door) { return std::string(door.param.name); });

TEST(Mutation, IsAFunctionOfItsNumber) {
    const std::vector<Bytes> corpus{{1, 2, 3, 4, 5, 6, 7, 8}, {'1', '2', ' ', '3'}};
    std::size_t changed = 0;
    for (std::uint64_t n = 0; n < 200; ++n) {
        const Bytes one = mutated(corpus, 1, n);
        EXPECT_EQ(one, mutated(corpus, 1, n));
        changed += one != corpus[0] && one != corpus[1] ? 1 : 0;
    }
    EXPECT_GT(changed, 150u);
}

}  // namespace
}  // namespace render2mpeg::fuzz
