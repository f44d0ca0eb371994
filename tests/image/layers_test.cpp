#include "image/layers.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStandardAttributes.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

#include "core/error.h"

namespace render2mpeg::image {
namespace {

namespace fs = std::filesystem;

constexpr int width = 3, height = 2;

struct Layer {
    bool half = false;
    std::vector<float> values;
};

/// All channels of a file, as OpenEXR reads them.
std::map<std::string, Layer> read_layers(const fs::path& path) {
    Imf::InputFile file(path.c_str());
    std::map<std::string, Layer> layers;
    Imf::FrameBuffer frame;
    for (auto i = file.header().channels().begin(); i != file.header().channels().end(); ++i) {
        Layer& layer = layers[i.name()];
        layer.half = i.channel().type == Imf::HALF;
        layer.values.resize(width * height);
        frame.insert(i.name(), Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(layer.values.data()), sizeof(float),
                                          sizeof(float) * width));
    }
    file.setFrameBuffer(frame);
    file.readPixels(0, height - 1);
    return layers;
}

/// A frame with a surface, the sky, a mirror, and nothing, one pixel each; the rest is surface.
struct Frame {
    core::Visible visible{7, width, height};
    core::Radiance radiance;
    core::MotionField to_previous, to_next;
    fs::path path = fs::temp_directory_path() / ("render2mpeg_layers_" + std::to_string(::getpid()) + ".exr");

    Frame() {
        radiance.combined = core::Plane<glm::vec3>(width, height, glm::vec3(0.25f, 0.5f, 1e6f));
        for (int i = 0; i < width * height; ++i) {
            const auto at = static_cast<std::size_t>(i);
            visible.kind.values()[at] = core::PixelClass::surface;
            visible.address.values()[at] = {static_cast<std::uint32_t>(i), 0, 0, 0};
            visible.material.values()[at] = 4;
            visible.depth.values()[at] = 2.5f;
            visible.shading_normal.values()[at] = core::PackedNormal({0, 1, 0});
            visible.geometric_normal.values()[at] = core::PackedNormal({1, 0, 0});
        }
        visible.kind.at(1, 0) = core::PixelClass::sky;
        visible.kind.at(2, 0) = core::PixelClass::reflected;
        visible.kind.at(0, 1) = core::PixelClass::none;
        for (const auto& [x, y] : {std::pair{1, 0}, {0, 1}}) {
            visible.address.at(x, y) = {};
            visible.material.at(x, y) = core::no_id;
            visible.depth.at(x, y) = std::numeric_limits<float>::infinity();
        }

        // It came 4 pixels from the left and 2 from below, and goes 6 to the right and 3 upwards; y points down here.
        for (core::MotionField* field : {&to_previous, &to_next}) field->kind = visible.kind;
        to_previous.vector = core::Plane<glm::vec2>(width, height, {-4, 2});
        to_next.vector = core::Plane<glm::vec2>(width, height, {6, -3});
    }
    ~Frame() { fs::remove(path); }

    std::map<std::string, Layer> written(bool with_previous = true, bool with_next = true) const {
        write_layers(path, visible, radiance, with_previous ? &to_previous : nullptr, with_next ? &to_next : nullptr);
        return read_layers(path);
    }
};

TEST(Layers, VectorFollowsBlendersConvention) {
    // What Blender wrote for this motion, measured with 3.4.1: previous minus current, then current minus next, y up.
    const auto layers = Frame().written();
    const glm::vec4 expected{-4, -2, -6, -3};
    for (int c = 0; c < 4; ++c) {
        const Layer& layer = layers.at(std::string("ViewLayer.Vector.") + "XYZW"[c]);
        EXPECT_FALSE(layer.half);
        for (const int i : {0, 1, 2, 4, 5}) EXPECT_EQ(layer.values[static_cast<std::size_t>(i)], expected[c]);
        EXPECT_EQ(layer.values[3], 0) << "nothing has no motion";
    }
}

TEST(Layers, AMissingNeighbourHasNoMotion) {
    const Frame frame;
    auto layers = frame.written(false, true);
    EXPECT_EQ(layers.at("ViewLayer.Vector.X").values[0], 0);
    EXPECT_EQ(layers.at("ViewLayer.Vector.W").values[0], -3);
    layers = frame.written(false, false);
    EXPECT_EQ(layers.count("ViewLayer.Vector.X"), 0u);
}

TEST(Layers, SurfacesAreToldWithIndicesFromOne) {
    const auto layers = Frame().written();
    const auto value = [&](const char* name, std::size_t i) { return layers.at(name).values[i]; };
    EXPECT_EQ(value("ViewLayer.Depth.Z", 0), 2.5f);
    EXPECT_EQ(value("ViewLayer.Depth.Z", 1), 1e10f);
    EXPECT_EQ(value("ViewLayer.Depth.Z", 3), 1e10f);
    EXPECT_EQ(value("ViewLayer.IndexOB.X", 0), 1);
    EXPECT_EQ(value("ViewLayer.IndexOB.X", 5), 6);
    EXPECT_EQ(value("ViewLayer.IndexOB.X", 1), 0);
    EXPECT_EQ(value("ViewLayer.IndexMA.X", 2), 5);
    EXPECT_EQ(value("ViewLayer.IndexMA.X", 3), 0);
    EXPECT_NEAR(value("ViewLayer.Normal.Y", 0), 1, 1e-4);
    EXPECT_NEAR(value("ViewLayer.Normal.Y", 2), 1, 1e-4);
    EXPECT_EQ(value("ViewLayer.Normal.Y", 1), 0);
    EXPECT_NEAR(value("render2mpeg.GeometricNormal.X", 5), 1, 1e-4);
    for (const auto& [i, kind] : {std::pair{0, 1.0f}, {1, 2.0f}, {2, 3.0f}, {3, 0.0f}})
        EXPECT_EQ(value("render2mpeg.Class.X", static_cast<std::size_t>(i)), kind);
}

TEST(Layers, ColoursAreHalvesAndNeverInfinite) {
    const auto layers = Frame().written();
    for (const char* name :
         {"ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B", "ViewLayer.Combined.A"})
        EXPECT_TRUE(layers.at(name).half);
    EXPECT_EQ(layers.at("ViewLayer.Combined.R").values[0], 0.25f);
    EXPECT_EQ(layers.at("ViewLayer.Combined.B").values[0], 65504.0f);
    EXPECT_EQ(layers.at("ViewLayer.Combined.A").values[1], 1.0f);
    EXPECT_EQ(layers.count("ViewLayer.DiffDir.R"), 0u) << "layers that were not computed are not there";
}

TEST(Layers, PartsOfLightAddUpToTheWhole) {
    Frame frame;
    const auto plane = [](glm::vec3 v) { return core::Plane<glm::vec3>(width, height, v); };
    frame.radiance.albedo = plane({0.5f, 0.25f, 1});
    frame.radiance.direct_irradiance = plane({2, 4, 8});
    frame.radiance.indirect_irradiance = plane({1, 1, 1});
    frame.radiance.emission = plane({0.5f, 0, 0});
    frame.radiance.glossy = plane({0, 0.125f, 0});
    frame.radiance.specular = plane({0, 0, 0.25f});
    frame.radiance.direct_cut = frame.radiance.indirect_cut = core::Plane<float>(width, height, 42);
    frame.radiance.record_density = frame.radiance.record_age = frame.radiance.record_reuse =
        core::Plane<float>(width, height, 3);
    for (glm::vec3& v : frame.radiance.combined.values())
        v = glm::vec3(0.5f, 0.25f, 1) * glm::vec3(3, 5, 9) + glm::vec3(0.5f, 0.125f, 0.25f);
    const auto layers = frame.written();
    for (const char c : {'R', 'G', 'B'})
        for (std::size_t i = 0; i < width * height; ++i) {
            const auto value = [&](std::string layer) { return layers.at(layer + "." + c).values[i]; };
            EXPECT_FLOAT_EQ(value("ViewLayer.Combined"),
                            value("ViewLayer.DiffCol") * (value("ViewLayer.DiffDir") + value("ViewLayer.DiffInd")) +
                                value("ViewLayer.Emit") + value("ViewLayer.Env") + value("render2mpeg.Glossy") +
                                value("render2mpeg.Specular"));
            EXPECT_EQ(value("ViewLayer.Env"), i == 1 && c == 'R' ? 0.5f : 0.0f)
                << "the sky's emission is Env, all other Emit";
        }
    EXPECT_EQ(layers.at("render2mpeg.CutDirect.X").values[0], 42);
    EXPECT_EQ(layers.at("render2mpeg.CutIndirect.X").values[0], 42);
    for (const char* layer : {"render2mpeg.RecordDensity.X", "render2mpeg.RecordAge.X", "render2mpeg.RecordReuse.X"})
        EXPECT_EQ(layers.at(layer).values[0], 3) << layer;
    EXPECT_EQ(layers.count("render2mpeg.Tolerance.X"), 0u);
}

TEST(Layers, SizesMustAgree) {
    Frame frame;
    frame.radiance.combined = core::Plane<glm::vec3>(width, height + 1);
    EXPECT_THROW(frame.written(), core::ContractViolation);
    frame.radiance.combined = core::Plane<glm::vec3>(width, height);
    frame.to_next.vector = core::Plane<glm::vec2>(1, 1);
    EXPECT_THROW(frame.written(), core::ContractViolation);
}

TEST(Layers, TheRadianceStandsUnderPlainNamesToo) {
    const auto layers = Frame().written();
    for (const char c : {'R', 'G', 'B', 'A'})
        EXPECT_EQ(layers.at(std::string(1, c)).values, layers.at(std::string("ViewLayer.Combined.") + c).values);
    EXPECT_TRUE(layers.at("A").half);
}

TEST(Layers, TheHeaderTellsColoursExposureTimeAndCamera) {
    const Frame frame;
    glm::mat4 camera(2), ndc(3);
    camera[3] = {4, 5, 6, 1};
    const FrameFacts facts{1, -1.5f, core::Rational{30000, 1001}, camera, ndc};
    const auto check = [&] {
        const Imf::InputFile file(frame.path.c_str());
        const Imf::Header& header = file.header();
        ASSERT_TRUE(Imf::hasChromaticities(header));
        const Imf::Chromaticities& colors = Imf::chromaticities(header);
        EXPECT_EQ(colors.red, Imath::V2f(0.64f, 0.33f));
        EXPECT_EQ(colors.green, Imath::V2f(0.3f, 0.6f));
        EXPECT_EQ(colors.blue, Imath::V2f(0.15f, 0.06f));
        EXPECT_EQ(colors.white, Imath::V2f(0.3127f, 0.329f));
        EXPECT_EQ(header.typedAttribute<Imf::FloatAttribute>("exposure").value(), -1.5f);
        EXPECT_EQ(Imf::framesPerSecond(header).n, 30000);
        EXPECT_EQ(Imf::framesPerSecond(header).d, 1001u);
        // A row times the matrix: what is moved stands in the last row.
        EXPECT_EQ(Imf::worldToCamera(header)[3][1], 5);
        EXPECT_EQ(Imf::worldToCamera(header)[1][1], 2);
        EXPECT_EQ(Imf::worldToNDC(header)[3][3], 3);
    };
    write_layers(frame.path, frame.visible, frame.radiance, nullptr, nullptr, facts);
    check();
    write_frame(frame.path, frame.radiance.combined, facts);
    check();
    write_frame(frame.path, frame.radiance.combined);
    EXPECT_EQ(Imf::InputFile(frame.path.c_str()).header().findTypedAttribute<Imf::FloatAttribute>("exposure"), nullptr)
        << "what is not known is not said";
}

TEST(Layers, AFrameAloneIsFourHalves) {
    const Frame frame;
    write_frame(frame.path, frame.radiance.combined);
    const auto layers = read_layers(frame.path);
    ASSERT_EQ(layers.size(), 4u);
    EXPECT_EQ(layers.at("A").values[5], 1);
    EXPECT_EQ(layers.at("R").values[5], 0.25f);
    EXPECT_EQ(layers.at("G").values[5], 0.5f);
    EXPECT_TRUE(layers.at("B").half);
}

}  // namespace
}  // namespace render2mpeg::image
