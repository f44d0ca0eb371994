// After decoupled sampling [RaganKelley2011]: light is gathered once for a surface point, visibility is sampled over
// the shutter and the lens. Changed: points lie where the middle of the shutter and of the lens shows them, one for
// each pixel there and surface, so that they are those of the sharp picture wherever that shows them; textures are the
// samples' own.
#include "renderer/view/expose.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/view/blur.h"
#include "renderer/view/exposed_points.h"
#include "renderer/view/exposure_need.h"
#include "renderer/view/exposure_pattern.h"
#include "renderer/view/tile_visibility.h"

namespace render2mpeg::renderer {
namespace {

/// Rays that are traced together. chosen: as tile_visibility.cpp.
constexpr int most_rays_together = 1024;

/// Looks for blur in tiles where none is known, sample by sample at other places. chosen: 16 a tile, one for each of
/// its blocks of 4 x 4 pixels.
constexpr int scouts = 16;

/// State that all tiles share.
struct Exposing {
    const PosedScene& scene;
    const EyePaths& paths;
    const Blur& blur;
    Frame& seen;
    Exposure& exposure;
    const ExposureSamples& samples;
    const std::vector<scene::Camera>& cameras;
    std::map<int, std::vector<glm::vec2>> places;
    std::map<int, ExposurePattern> patterns;
    std::vector<std::vector<std::uint32_t>> starts;  ///< of pixels in `seen.tiles`
    core::Plane<std::uint8_t> near_white;            ///< see exposure_need.h
    core::Plane<glm::vec2> motions;                  ///< of pixels' middles; empty where the lens blurs, too

    const scene::Camera& camera_at(float time) const {
        const auto k = static_cast<std::size_t>(time * static_cast<float>(cameras.size()));
        return cameras[std::min(k, cameras.size() - 1)];
    }
    void prepare(int samples) {
        if (patterns.contains(samples)) return;
        patterns.emplace(samples, samples);
        places.emplace(samples, sample_pattern(samples));
    }
};

/// Samples the pixels of one tile.
class TileExposer {
  public:
    TileExposer(const Exposing& all, std::size_t tile, int samples)
        : all_(all), tile_(tile), area_(area_of(all.seen, tile)), samples_(samples) {
        use(samples);
    }

    void expose(TileExposure& found);
    /// How far a few samples of the tile are blurred.
    float scout(ExposureCounts& counts);

  private:
    void use(int samples);
    void aim(int x, int y, int sample, EyeRays& rays);
    void aim_all(int x, int y, EyeRays& rays);
    void expose(int x, int y, std::size_t first_ray, TileExposure& found);
    std::optional<BrightSamples> look(int x, int y, const EyeRays& rays, std::size_t first, TileExposure& found);
    glm::vec2 even_motion(int x, int y) const;
    bool was_blurred(int x, int y) const;
    /// Whether the sample shows the object that the sharp picture shows of a pixel.
    bool shows_same(int x, int y) const {
        const core::Visible& visible = all_.seen.visible;
        return sample_.main.kind == visible.kind.at(x, y) &&
               sample_.main.point.address.object == visible.address.at(x, y).object;
    }
    void forget_pixel(int x, int y, TileExposure& found) const {
        forget_air(pixel_at(x, y), found.air);
        forget_mattes(pixel_at(x, y), found.mattes);
        forget_fibres(pixel_at(x, y), found.fibres);
    }
    float blur_of(const EyeSample& sample, glm::vec2 position) const;
    void to_middle(Fragment& fragment, float time) const;
    void take(Fragment& fragment, int x, int y, float time, std::size_t first, TileExposure& found);
    std::pair<std::uint32_t, std::uint32_t> point_for(const Fragment& fragment, int x, int y, TileExposure& found);
    std::uint16_t pixel_at(int x, int y) const {
        return static_cast<std::uint16_t>(y % tile_size * tile_size + x % tile_size);
    }

    const Exposing& all_;
    std::size_t tile_;
    TileArea area_;
    int samples_;  ///< of most pixels
    const ExposurePattern* pattern_ = nullptr;
    const std::vector<glm::vec2>* places_ = nullptr;
    float spacing_ = 1;
    glm::vec2 along_{0};  ///< direction along which the pixel's samples lie in its middle
    EyeSample sample_;
    SeeCounts see_counts_;
    EyeRays rays_, again_;  ///< of the pixels of a row, and of one pixel's second look
};

void TileExposer::use(int samples) {
    pattern_ = &all_.patterns.at(samples);
    places_ = &all_.places.at(samples);
    spacing_ = 1.0f / std::sqrt(static_cast<float>(samples));
}

void TileExposer::aim(int x, int y, int sample, EyeRays& rays) {
    const int dither = dither_class(x, y);
    const scene::Snapshot& snapshot = all_.scene.posed();
    float time = pattern_->time(sample, dither);
    if (snapshot.sweep)
        time = snapshot.sweep->shutter.of_row(
            time, (static_cast<float>(y) + 0.5f) / static_cast<float>(all_.seen.visible.height()));
    const scene::Camera& camera = all_.camera_at(time);
    const glm::vec2 lens = camera.has_aperture() ? pattern_->lens(sample, dither, camera.lens()) : glm::vec2(0);
    glm::vec2 place = (*places_)[static_cast<std::size_t>(sample)] - 0.5f;
    place -= glm::dot(place, along_) * along_;
    const glm::vec2 position = glm::vec2{static_cast<float>(x), static_cast<float>(y)} + 0.5f + place;
    float far = 0;
    EyeRay ray = eye_ray(camera, position, spacing_, far, lens);
    ray.time = time;
    rays.add(ray, far, {x, y}, sample);
}

float TileExposer::blur_of(const EyeSample& sample, glm::vec2 position) const {
    float blur = 0;
    switch (sample.main.kind) {
        case core::PixelClass::none:
            break;
        case core::PixelClass::sky:
            blur = all_.blur.of_sky(position);
            break;
        default:
            blur = all_.blur.of(sample.main.point.address);
    }
    for (const Fragment& f : sample.fragments) {
        blur = std::max(blur, all_.blur.of(f.point.address));
        if (f.path == direct_path) continue;
        const float pixel = all_.scene.posed().camera.pixel_size();
        blur = std::max(blur, all_.blur.of_distance(core::divide_or(f.extent, spacing_ * pixel, 1.0f)));
    }
    return blur;
}

float TileExposer::scout(ExposureCounts& counts) {
    constexpr int side = 4, step = tile_size / side;
    rays_.clear();
    std::vector<glm::vec2> places;
    for (int k = 0; k < scouts; ++k) {
        const int x = area_.first.x + k % side * step + k / side, y = area_.first.y + k / side * step + k % side;
        if (x >= area_.end.x || y >= area_.end.y) continue;
        aim(x, y, k % pattern_->samples(), rays_);
        places.emplace_back(x, y);
    }
    rays_.trace(all_.scene.tracer());
    float blur = 0;
    for (std::size_t k = 0; k < rays_.hits.size(); ++k) {
        all_.paths.look(rays_.rays[k], rays_.queries[k].far, rays_.hits[k], sample_, see_counts_);
        blur = std::max(blur, blur_of(sample_, places[k]));
    }
    counts.rays += see_counts_.primary_rays + see_counts_.specular_rays;
    return blur;
}

/// Whether a surface that the sharp picture shows in a pixel is blurred.
bool TileExposer::was_blurred(int x, int y) const {
    if (all_.blur.of_pixel(all_.seen.visible, x, y) >= least_blur) return true;
    const GatherTile& points = all_.seen.tiles[tile_];
    const std::uint16_t pixel = pixel_at(x, y);
    for (std::uint32_t i = all_.starts[tile_][pixel]; i < all_.starts[tile_][pixel + 1u]; ++i)
        if (all_.blur.of(points[i].point.address) >= least_blur) return true;
    return false;
}

/// The direction in which all about a pixel moves alike, by two pixels or more: strata of time part that evenly, and
/// places along it would only disturb them. 0: there is none.
glm::vec2 TileExposer::even_motion(int x, int y) const {
    // chosen: two pixels, of which the pixel's own box is too little to see; a quarter, not tuned.
    constexpr float least_motion = 2, same_motion = 0.25f;
    const core::Plane<glm::vec2>& motions = all_.motions;
    if (motions.empty()) return glm::vec2(0);
    const glm::vec2 motion = motions.at(x, y);
    const float length = glm::length(motion);
    if (!(length >= least_motion)) return glm::vec2(0);
    for (int j = std::max(y - 1, 0); j <= std::min(y + 1, motions.height() - 1); ++j)
        for (int i = std::max(x - 1, 0); i <= std::min(x + 1, motions.width() - 1); ++i)
            if (glm::length(motions.at(i, j) - motion) > same_motion * length) return glm::vec2(0);
    return motion / length;
}

/// Moves a fragment to its place in the middle of the shutter.
void TileExposer::to_middle(Fragment& fragment, float time) const {
    const scene::Snapshot& snapshot = all_.scene.posed();
    SurfacePoint& p = fragment.point;
    if (snapshot.sweep && snapshot.sweep->object_moves(p.address.object)) {
        const SurfaceShape then = all_.scene.shape_at(p.address, time),
                           middle = all_.scene.shape_at(p.address, scene::middle_time);
        const float side = p.back_side ? -1.0f : 1.0f;
        p.position = middle.position;
        p.position_error = middle.position_error;
        p.geometric_normal = side * middle.front_normal;
        const glm::vec3 turned = p.shading_normal + side * (middle.smooth_normal - then.smooth_normal);
        p.shading_normal = core::normalize_or(turned, p.geometric_normal);
    }
    if (fragment.path != direct_path) return;
    // It is looked at from the eye, unless that sees its other side.
    const glm::vec3 to_eye = core::normalize_or(
        snapshot.camera.has_eye() ? snapshot.camera.eye_of(p.position) - p.position : -snapshot.camera.forward(),
        p.outgoing);
    if (glm::dot(to_eye, p.geometric_normal) > 0.0f)
        p.outgoing = to_eye;
    else if (!(glm::dot(p.outgoing, p.geometric_normal) > 0.0f))
        p.outgoing = p.geometric_normal;
}

/// The point that a fragment's light is gathered at: one that is there, or a new one.
std::pair<std::uint32_t, std::uint32_t> TileExposer::point_for(const Fragment& fragment, int x, int y,
                                                               TileExposure& found) {
    const float extent = core::divide_or(fragment.extent, spacing_, 0.0f);
    int cell_x = x, cell_y = y;
    if (fragment.path == direct_path) {
        const auto place = all_.scene.posed().camera.project(fragment.point.position);
        const core::Visible& visible = all_.seen.visible;
        if (place && place->position.x >= 0 && place->position.y >= 0 &&
            place->position.x < static_cast<float>(visible.width()) &&
            place->position.y < static_cast<float>(visible.height())) {
            cell_x = static_cast<int>(place->position.x);
            cell_y = static_cast<int>(place->position.y);
        }
    }
    const auto tile = static_cast<std::uint32_t>(cell_y / tile_size * all_.seen.tiles_across() + cell_x / tile_size);
    const std::uint16_t pixel = pixel_at(cell_x, cell_y);
    const GatherTile& points = all_.seen.tiles[tile];
    for (std::uint32_t i = all_.starts[tile][pixel]; i < all_.starts[tile][pixel + 1u]; ++i)
        if (same_surface(points[i], fragment, extent)) return {tile, i};
    const auto known = found.in_cell.find(TileExposure::cell_of(tile, pixel));
    if (known != found.in_cell.end())
        for (const std::uint32_t k : known->second)
            if (same_surface(found.points[k].point, fragment, extent)) return {tile, is_new | k};
    NewPoint added;
    added.point.point = fragment.point;
    added.point.pixel = pixel;
    added.point.path = fragment.path;
    added.extent = extent;
    added.tile = tile;
    added.source = pixel_at(x, y);
    added.found_tile = static_cast<std::uint32_t>(tile_);
    found.add(std::move(added));
    return {tile, is_new | static_cast<std::uint32_t>(found.points.size() - 1)};
}

void TileExposer::take(Fragment& fragment, int x, int y, float time, std::size_t first, TileExposure& found) {
    const glm::vec3 weight = fragment.weight / static_cast<float>(pattern_->samples());
    if (fragment.point.is_sampled()) {
        found.fibres.push_back(fibre_sample(fragment, pixel_at(x, y), weight));
        return;
    }
    const glm::vec3 diffuse = weight * fragment.point.bsdf.diffuse;
    to_middle(fragment, time);
    const std::size_t new_points = found.points.size();
    const auto [tile, point] = point_for(fragment, x, y, found);
    if (found.points.size() > new_points) {
        NewPoint& added = found.points.back();
        added.point.weight = weight;
        const scene::Snapshot& snapshot = all_.scene.posed();
        if (snapshot.sweep && snapshot.sweep->object_moves(fragment.point.address.object)) {
            SurfacePoint& p = added.point.point;
            const SurfacePoint middle = all_.scene.surface_at(p.address, p.outgoing);
            p.smooth = middle.smooth;
        }
    }
    if ((point & is_new) != 0)
        found.points[point & ~is_new].spread.add(fragment.point.shading_normal, fragment.turn,
                                                 weight.x + weight.y + weight.z);
    for (std::size_t k = first; k < found.parts.size(); ++k) {
        TileExposure::Part& part = found.parts[k];
        if (part.tile != tile || part.point != point) continue;
        part.weight += weight;
        part.diffuse += diffuse;
        return;
    }
    found.parts.push_back({tile, point, weight, diffuse});
}

/// Bright samples of a pixel; nothing where none of it is blurred.
std::optional<BrightSamples> TileExposer::look(int x, int y, const EyeRays& rays, std::size_t first_ray,
                                               TileExposure& found) {
    const std::size_t first = found.parts.size(), new_points = found.points.size();
    BrightSamples bright;
    const glm::vec2 middle{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
    glm::vec3 emitted(0), specular(0);
    bool blurred = was_blurred(x, y);
    int same = 0;
    for (int s = 0; s < pattern_->samples(); ++s) {
        const std::size_t ray = first_ray + static_cast<std::size_t>(s);
        all_.paths.look(rays.rays[ray], rays.queries[ray].far, rays.hits[ray], sample_, see_counts_);
        same += shows_same(x, y) ? 1 : 0;
        emitted += sample_.emitted;
        bright.add(core::luminance(sample_.emitted));
        specular += sample_.emitted_specular;
        if (all_.scene.air() != nullptr)
            add_air(sample_, pixel_at(x, y), 1.0f / static_cast<float>(pattern_->samples()), found.air);
        add_mattes(sample_.mattes, pixel_at(x, y), 1.0f / static_cast<float>(pattern_->samples()), found.mattes);
        blurred = blurred || blur_of(sample_, middle) >= least_blur;
        for (Fragment& fragment : sample_.fragments) take(fragment, x, y, rays.rays[ray].time, first, found);
    }
    found.counts.samples += static_cast<std::uint64_t>(pattern_->samples());
    if (!blurred) {
        found.forget_from(first, new_points);
        forget_pixel(x, y, found);
        all_.exposure.exposed.at(x, y) = 0;
        return {};
    }
    ++found.counts.pixels;
    const auto share = 1.0f / static_cast<float>(pattern_->samples());
    all_.exposure.exposed.at(x, y) = 1;
    all_.exposure.coverage.at(x, y) = share * static_cast<float>(same);
    all_.exposure.emitted.at(x, y) = share * emitted;
    if (!all_.exposure.emitted_specular.empty()) all_.exposure.emitted_specular.at(x, y) = share * specular;
    return bright;
}

void TileExposer::aim_all(int x, int y, EyeRays& rays) {
    along_ = even_motion(x, y);
    for (int s = 0; s < pattern_->samples(); ++s) aim(x, y, s, rays);
}

/// Takes a pixel's samples, and more of them where so few would show.
void TileExposer::expose(int x, int y, std::size_t first_ray, TileExposure& found) {
    const std::size_t first = found.parts.size(), new_points = found.points.size();
    const std::optional<BrightSamples> bright = look(x, y, rays_, first_ray, found);
    const bool near_white = !all_.near_white.empty() && all_.near_white.at(x, y) != 0;
    const int needed = bright ? bright->needed(samples_, near_white, all_.samples) : samples_;
    if (needed == samples_) return;
    found.forget_from(first, new_points);
    forget_pixel(x, y, found);
    --found.counts.pixels;
    use(needed);
    again_.clear();
    aim_all(x, y, again_);
    again_.trace(all_.scene.tracer());
    look(x, y, again_, 0, found);
    use(samples_);
}

void TileExposer::expose(TileExposure& found) {
    found.starts.assign(tile_size * tile_size + 1, 0);
    const int together = std::max(1, most_rays_together / samples_);
    for (int y = area_.first.y; y < area_.first.y + tile_size; ++y)
        for (int x = area_.first.x; x < area_.first.x + tile_size; ++x) {
            found.starts[pixel_at(x, y)] = static_cast<std::uint32_t>(found.parts.size());
            if (x >= area_.end.x || y >= area_.end.y) continue;
            if ((x - area_.first.x) % together == 0) {
                rays_.clear();
                for (int k = x; k < std::min(x + together, area_.end.x); ++k) aim_all(k, y, rays_);
                rays_.trace(all_.scene.tracer());
            }
            expose(x, y, static_cast<std::size_t>((x - area_.first.x) % together * samples_), found);
        }
    found.starts.back() = static_cast<std::uint32_t>(found.parts.size());
    found.counts.rays += see_counts_.primary_rays + see_counts_.specular_rays;
    if (found.counts.pixels == 0) found = {{}, {}, {}, {}, found.counts, {}, {}};
}

/// Where pixels' points begin in their tile.
std::vector<std::vector<std::uint32_t>> starts_of(const Frame& seen) {
    std::vector<std::vector<std::uint32_t>> starts(seen.tiles.size());
    parallel::for_each(seen.tiles.size(), [&](std::size_t t) {
        starts[t].assign(tile_size * tile_size + 1, 0);
        for (const GatherPoint& p : seen.tiles[t]) ++starts[t][p.pixel + 1u];
        for (std::size_t k = 1; k < starts[t].size(); ++k) starts[t][k] += starts[t][k - 1];
    });
    return starts;
}

/// Samples all tiles that may be blurred.
std::vector<TileExposure> sample_tiles(Exposing& all, ExposureCounts& counts) {
    const scene::Snapshot& snapshot = all.scene.posed();
    const ExposureSamples& samples = all.samples;
    for (int n = samples.fewest; n < samples.most; n *= 2) all.prepare(n);
    for (int n = samples.most; n <= most_samples_of(samples); n *= 2) all.prepare(n);
    all.prepare(scouts);
    const std::size_t tiles = all.seen.tiles.size();
    std::vector<float> scouted(tiles, 0.0f);
    std::vector<ExposureCounts> scout_counts(tiles);
    parallel::for_each(tiles, [&](std::size_t t) { scouted[t] = TileExposer(all, t, scouts).scout(scout_counts[t]); });
    const std::vector<float> blurs = blur_of_tiles(all.blur, snapshot, all.seen, scouted);
    std::vector<TileExposure> found(tiles);
    parallel::for_each(tiles, [&](std::size_t t) {
        if (blurs[t] > 0)
            TileExposer(all, t, samples_for(blurs[t], snapshot.camera.has_aperture(), samples)).expose(found[t]);
    });
    for (std::size_t t = 0; t < tiles; ++t) {
        counts.rays += scout_counts[t].rays + found[t].counts.rays;
        counts.pixels += found[t].counts.pixels;
        counts.samples += found[t].counts.samples;
    }
    return found;
}

/// Exposure::given.
std::vector<float> given_by_points(const Exposure& exposure) {
    std::vector<float> given(exposure.first_point.back());
    for (const std::vector<Contribution>& of_tile : exposure.contributions)
        for (const Contribution& c : of_tile) given[c.point] += core::luminance(c.weight);
    return given;
}

}  // namespace

Frame expose(const PosedScene& posed_scene, const SeeSettings& settings, const Plan& plan,
             const ExposureSamples& samples, Frame seen, ExposureCounts& counts) {
    EXPECTS(samples.fewest >= 1 && samples.fewest <= samples.most && samples.most <= 4096);
    const scene::Snapshot& snapshot = posed_scene.posed();
    const Blur blur(snapshot);
    if (!blur.any()) return seen;
    const EyePaths paths(posed_scene, settings, plan);
    const std::vector<scene::Camera> cameras = scene::cameras_over(snapshot, samples.most * dither_classes);
    auto exposure = std::make_shared<Exposure>();
    exposure->exposed = core::Plane<std::uint8_t>(seen.visible.width(), seen.visible.height(), 0);
    exposure->coverage = core::Plane<float>(seen.visible.width(), seen.visible.height(), 1.0f);
    exposure->emitted = core::Plane<glm::vec3>(seen.visible.width(), seen.visible.height(), glm::vec3(0));
    if (!seen.emitted_specular.empty()) exposure->emitted_specular = exposure->emitted;
    Exposing all{posed_scene,
                 paths,
                 blur,
                 seen,
                 *exposure,
                 samples,
                 cameras,
                 {},
                 {},
                 starts_of(seen),
                 near_white(blur, seen, samples),
                 {}};
    if (!snapshot.camera.has_aperture()) all.motions = blur.motions(seen.visible);
    std::vector<TileExposure> found = sample_tiles(all, counts);
    if (counts.pixels == 0) {
        blur_shadows(snapshot, seen);
        return seen;
    }

    const std::size_t tiles = seen.tiles.size();
    PointMerger merger(found, *exposure, seen);
    parallel::for_each(tiles, [&](std::size_t t) { merger.merge(t); });
    blur_shadows(snapshot, seen);
    exposure->first_point.push_back(0);
    for (const GatherTile& tile : seen.tiles)
        exposure->first_point.push_back(exposure->first_point.back() + static_cast<std::uint32_t>(tile.size()));
    for (std::size_t t = 0; t < tiles; ++t)
        counts.points += seen.tiles[t].size() - (all.starts[t].empty() ? 0 : all.starts[t].back());
    exposure->contributions.resize(tiles);
    exposure->starts.resize(tiles);
    if (posed_scene.air() != nullptr) exposure->air.resize(tiles);
    if (!seen.mattes.empty()) exposure->mattes.resize(tiles);
    if (!seen.fibres.empty()) exposure->fibres.resize(tiles);
    parallel::for_each(tiles, [&](std::size_t t) {
        exposure->starts[t] = std::move(found[t].starts);
        if (!exposure->air.empty()) exposure->air[t] = std::move(found[t].air);
        if (!exposure->mattes.empty()) exposure->mattes[t] = std::move(found[t].mattes);
        if (!exposure->fibres.empty()) exposure->fibres[t] = std::move(found[t].fibres);
        for (const TileExposure::Part& part : found[t].parts) {
            const auto [tile, point] = merger.of(t, part);
            exposure->contributions[t].push_back({exposure->first_point[tile] + point, part.weight, part.diffuse});
        }
    });
    exposure->given = given_by_points(*exposure);
    seen.exposure = std::move(exposure);
    return seen;
}

}  // namespace render2mpeg::renderer
