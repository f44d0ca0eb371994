#include "app/system/image_reader.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "app/system/interrupt.h"
#include "image/image.h"
#include "support/program.h"

/// Images of strangers are tried in processes of their own, within the memory that there is.
namespace render2mpeg {
namespace {

using app::ImageProbes;
using app::ImageReader;

constexpr std::uintmax_t mib = std::uintmax_t{1} << 20;
/// An image of 2048 x 1536 pixels takes 48 MiB when it is read, and more on the way.
constexpr int wide = 2048, tall = 1536;
constexpr ImageProbes little{2, 8 * mib, 8 * mib}, little_each{2, 8 * mib, 512 * mib}, enough{2, 512 * mib, 512 * mib};

/// A scene whose sky and only surface show the first and the last image.
std::shared_ptr<const scene::Animation> scene_of(const std::vector<std::filesystem::path>& files) {
    const auto made = std::make_shared<scene::Animation>();
    scene::Animation& film = *made;
    for (const std::filesystem::path& file : files) film.images.push_back({file.string(), file, {}});
    film.sky.image = 0;
    film.materials.emplace_back();
    film.materials[0].base_color_texture.image = static_cast<int>(files.size()) - 1;
    film.objects.emplace_back();
    film.objects[0].material = 0;
    return made;
}

std::string refusal_of(ImageReader& reader, int image) {
    try {
        reader.take(image);
    } catch (const core::Error& error) {
        return error.what();
    }
    return {};
}

/// As PNG and as OpenEXR.
std::vector<std::filesystem::path> images_in(const support::Folder& folder) {
    std::vector<std::filesystem::path> files{folder / "a.png", folder / "b.exr"};
    image::write_png(files[0], wide, tall, std::vector<unsigned char>(std::size_t{3} * wide * tall, 9));
    std::vector<image::Channel> channels;
    for (const char* name : {"R", "G", "B"})
        channels.push_back({name, std::vector<float>(std::size_t{1} * wide * tall, 0.5f), true});
    image::write_exr(files[1], wide, tall, channels);
    return files;
}

#ifndef RENDER2MPEG_SANITIZED
TEST(ImageReader, RefusesImagesThatTakeAllMemorySlow) {
    const support::Folder folder;
    for (const std::filesystem::path& file : images_in(folder)) {
        EXPECT_TRUE(ImageReader(scene_of({file})).read_ahead(enough)) << file;
        try {
            ImageReader(scene_of({file})).read_ahead(little);
            ADD_FAILURE() << file << " is read again, in this process, which has no limit";
        } catch (const scene::OutOfMemory& error) {
            EXPECT_NE(std::string(error.what()).find(file.string() + ": takes more memory"), std::string::npos)
                << error.what();
        }
    }
}
#endif

TEST(ImageReader, GivesAnImageThatNeedsMoreThanItsShareAllOfItSlow) {
    const support::Folder folder;
    EXPECT_TRUE(ImageReader(scene_of(images_in(folder))).read_ahead(little_each));
}

TEST(ImageReader, HandsOverThePixelsThatAreReadHereSlow) {
    const support::Folder folder;
    const std::vector<std::filesystem::path> files = images_in(folder);
    for (const bool ahead : {true, false}) {
        ImageReader reader(scene_of(files));
        EXPECT_TRUE(!ahead || reader.read_ahead(enough));
        for (int i = 0; i < 2; ++i) {
            const image::StoredImage far = reader.take(i), here = image::read_stored_image(files[i], {}, "");
            ASSERT_EQ(far.width, wide);
            ASSERT_EQ(far.height, tall);
            ASSERT_EQ(far.codes.size_bytes(), here.codes.size_bytes());
            ASSERT_EQ(far.values.size_bytes(), here.values.size_bytes());
            EXPECT_EQ(far.codes.empty(), i == 1) << "floats of an OpenEXR, code values of a PNG";
            EXPECT_EQ(std::memcmp(far.codes.data(), here.codes.data(), far.codes.size_bytes()), 0);
            EXPECT_EQ(std::memcmp(far.values.data(), here.values.data(), far.values.size_bytes()), 0);
            EXPECT_EQ(far.high_range, here.high_range);
            EXPECT_EQ(far.has_alpha, here.has_alpha);
        }
        reader.forget();
        EXPECT_EQ(reader.take(0).width, wide) << "what was forgotten is read again";
    }
}

TEST(ImageReader, KnowsHeadersWithoutPixels) {
    const support::Folder folder;
    ImageReader reader(scene_of(images_in(folder)));
    const auto headers = reader.headers();
    ASSERT_EQ(headers.size(), 2u);
    EXPECT_EQ(headers.at(0).width, wide);
    EXPECT_EQ(headers.at(1).height, tall);
    EXPECT_TRUE(headers.at(0).bytes);
    EXPECT_FALSE(headers.at(1).bytes);
}

TEST(ImageReader, TellsWhatIsRefusedOnlyWhereItIsLookedAt) {
    const support::Folder folder;
    std::ofstream(folder / "bad.png") << "\x89PNG\r\n\x1a\n and no more";
    std::ofstream(folder / "word.png") << "word";
    ImageReader reader(scene_of({folder / "bad.png", folder / "word.png"}));
    EXPECT_TRUE(reader.read_ahead(enough)) << "not every image is looked at";
    for (const char* name : {"bad.png", "word.png"}) {
        std::string here;
        try {
            image::read_image(folder / name, {}, (folder / name).string());
        } catch (const core::Error& error) {
            here = error.what();
        }
        EXPECT_NE(here, "");
        EXPECT_EQ(refusal_of(reader, name[0] == 'b' ? 0 : 1), here);
    }
}

TEST(ImageReader, NamesAProgramThatDoesNotStart) {
    const support::Folder folder;
    image::write_png(folder / "a.png", 1, 1, std::vector<unsigned char>{1, 2, 3});
    const auto told = [&](const std::string& program) {
        setenv("RENDER2MPEG_PROGRAM", program.c_str(), 1);
        ImageReader reader(scene_of({folder / "a.png"}));
        const std::string line = refusal_of(reader, 0);
        unsetenv("RENDER2MPEG_PROGRAM");
        return line;
    };
    std::ofstream(folder / "plain") << "no program";
    EXPECT_NE(told(folder / "plain").find("Permission denied"), std::string::npos);
    EXPECT_NE(told(folder / "none").find("No such file"), std::string::npos);
    EXPECT_NE(told("/bin/false")
                  .find("a.png: /bin/false, which should read it in a process of its own, does not "
                        "start (exit status 1)"),
              std::string::npos)
        << told("/bin/false");
}

TEST(ImageProbes, OneAtATimeWithinALimit) {
    EXPECT_EQ(app::image_probes(true).at_once, 1u);
    const ImageProbes free = app::image_probes(false);
    EXPECT_GE(free.at_once, 1u);
    EXPECT_LE(free.share, free.alone);
    // The largest image that is read: docs/measurements.md#memory.
    EXPECT_LE(free.alone, mib * 1024 + 48 * std::uintmax_t{image::max_pixels});
    EXPECT_GT(free.share * free.at_once, 256 * mib);
}

TEST(ImageReader, EndsWithAnInterrupt) {
    const support::Folder folder;
    ImageReader reader(scene_of({folder / "missing.png"}));
    const app::InterruptGuard guard(true);
    EXPECT_TRUE(reader.read_ahead(enough));
    std::raise(SIGTERM);
    EXPECT_FALSE(reader.read_ahead(enough));
}

}  // namespace
}  // namespace render2mpeg
