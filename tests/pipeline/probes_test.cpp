#include "app/system/probes.h"

#include <gtest/gtest.h>

#include <csignal>
#include <string>
#include <vector>

#include "app/system/interrupt.h"
#include "image/image.h"
#include "support/program.h"

/// Images of strangers are tried in processes of their own, within the memory that there is.
namespace render2mpeg {
namespace {

using app::ImageProbes;
using app::probe_images;

constexpr std::uintmax_t mib = std::uintmax_t{1} << 20;
/// An image of 2048 x 1536 pixels takes 48 MiB when it is read, and more on the way.
constexpr int wide = 2048, tall = 1536;
constexpr ImageProbes little{2, 8 * mib, 8 * mib}, little_each{2, 8 * mib, 512 * mib}, enough{2, 512 * mib, 512 * mib};

/// A scene whose sky and only surface show two images.
scene::Animation scene_of(const std::vector<std::filesystem::path>& files) {
    scene::Animation film;
    for (const std::filesystem::path& file : files) film.images.push_back({file.string(), file, {}});
    film.sky.image = 0;
    film.materials.emplace_back();
    film.materials[0].base_color_texture.image = static_cast<int>(files.size()) - 1;
    film.objects.emplace_back();
    film.objects[0].material = 0;
    return film;
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
TEST(ImageProbes, RefuseImagesThatTakeAllMemorySlow) {
    const support::Folder folder;
    for (const std::filesystem::path& file : images_in(folder)) {
        const scene::Animation film = scene_of({file});
        EXPECT_TRUE(probe_images(film, enough)) << file;
        try {
            probe_images(film, little);
            ADD_FAILURE() << file << " is read again, in this process, which has no limit";
        } catch (const scene::OutOfMemory& error) {
            EXPECT_NE(std::string(error.what()).find(file.string() + ": takes more memory"), std::string::npos)
                << error.what();
        }
    }
}
#endif

TEST(ImageProbes, GiveAnImageThatNeedsMoreThanItsShareAllOfItSlow) {
    const support::Folder folder;
    EXPECT_TRUE(probe_images(scene_of(images_in(folder)), little_each));
}

TEST(ImageProbes, DoNotTellWhatLibrariesRefuse) {
    const support::Folder folder;
    std::ofstream(folder / "bad.png") << "\x89PNG\r\n\x1a\n and no more";
    EXPECT_TRUE(probe_images(scene_of({folder / "bad.png"}), enough)) << "not every image is looked at";
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

TEST(ImageProbes, EndWithAnInterrupt) {
    const support::Folder folder;
    const scene::Animation film = scene_of({folder / "missing.png"});
    const app::InterruptGuard guard(true);
    EXPECT_TRUE(probe_images(film, enough));
    std::raise(SIGTERM);
    EXPECT_FALSE(probe_images(film, enough));
}

}  // namespace
}  // namespace render2mpeg
