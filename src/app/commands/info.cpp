#include "app/commands/commands.h"

#include <fmt/format.h>
#include <cstdint>
#include <numeric>
#include <optional>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "app/files/file_io.h"
#include "app/options/mistakes.h"
#include "app/report/figures.h"
#include "app/system/image_reader.h"
#include "app/system/terminal.h"
#include "core/error.h"
#include "core/text.h"
#include "encoder/av/inspect.h"
#include "encoder/av/levels.h"
#include "encoder/codec.h"

namespace render2mpeg::app {
namespace {

/// Sums and means over the pictures of one type.
struct CodedType {
    char type = '?';
    std::int64_t pictures = 0;
    std::int64_t bytes = 0;
    double quantiser = 0, min_quantiser = 0, max_quantiser = 0;
    double intra = 0;
    av::VectorFacts forward, backward;  ///< lengths: of all moving macroblocks; `longest` the longest of all
};

/// Pictures from one group's beginning to the next one's, the most there are; and the groups' number.
struct Groups {
    std::int64_t count = 0, longest = 0;
};

/// Adds a picture's vectors to those of its type: shares as sums, lengths weighted by what moves.
void add(av::VectorFacts& sum, const av::VectorFacts& picture) {
    sum.share += picture.share;
    sum.mean += picture.mean * picture.moving;
    sum.moving += picture.moving;
    sum.longest = std::max(sum.longest, picture.longest);
}

void finish(av::VectorFacts& sum, double pictures) {
    sum.mean = ratio_of(sum.mean, sum.moving);
    sum.share /= pictures;
    sum.moving /= pictures;
}

/// One row for every type that a film has, in the order I, P, B, others.
std::vector<CodedType> coded_types(const av::Inspection& film) {
    std::vector<CodedType> types(4);
    for (std::size_t i = 0; i < types.size(); ++i) types[i].type = "IPB?"[i];
    for (const av::PictureFacts& picture : film.pictures) {
        auto type = std::ranges::find(types, picture.type, &CodedType::type);
        CodedType& sum = type == types.end() ? types.back() : *type;
        sum.min_quantiser =
            sum.pictures == 0 ? picture.min_quantiser : std::min(sum.min_quantiser, picture.min_quantiser);
        sum.max_quantiser = std::max(sum.max_quantiser, picture.max_quantiser);
        sum.quantiser += picture.mean_quantiser;
        sum.intra += picture.intra;
        sum.bytes += picture.bytes;
        add(sum.forward, picture.forward);
        add(sum.backward, picture.backward);
        ++sum.pictures;
    }
    std::erase_if(types, [](const CodedType& type) { return type.pictures == 0; });
    for (CodedType& type : types) {
        const auto pictures = static_cast<double>(type.pictures);
        type.quantiser /= pictures;
        type.intra /= pictures;
        finish(type.forward, pictures);
        finish(type.backward, pictures);
    }
    return types;
}

std::int64_t coded_bytes(const av::Inspection& film) {
    return std::accumulate(film.pictures.begin(), film.pictures.end(), std::int64_t{0},
                           [](std::int64_t sum, const av::PictureFacts& picture) { return sum + picture.bytes; });
}

Groups groups_of(const av::Inspection& film) {
    std::vector<std::int64_t> starts;
    std::int64_t pictures = 0;
    for (const av::PictureFacts& picture : film.pictures) {
        if (picture.random_access) starts.push_back(picture.coded);
        pictures = std::max(pictures, picture.coded + 1);
    }
    std::ranges::sort(starts);
    starts.push_back(pictures);
    Groups groups{static_cast<std::int64_t>(starts.size()) - 1, 0};
    for (std::size_t i = 1; i < starts.size(); ++i)
        groups.longest = std::max(groups.longest, starts[i] - starts[i - 1]);
    return groups;
}

using nlohmann::json;

/// Duration, repeated fields included; 0: the rate is unknown.
double duration_of(const av::Inspection& film) {
    double fields = 0;
    for (const av::PictureFacts& picture : film.pictures) fields += 2 + picture.repeated_fields;
    return ratio_of(0.5 * fields, film.stream.rate.value());
}

bool is_damaged(const av::PictureFacts& picture) {
    return !picture.damage.empty();
}

std::int64_t damaged(const av::Inspection& film) {
    return std::ranges::count_if(film.pictures, &is_damaged);
}

std::string shape_text(const av::StreamFacts& stream) {
    if (stream.pixel_aspect.num == 0 || stream.pixel_aspect.num == stream.pixel_aspect.den || stream.height == 0)
        return {};
    const core::Rational whole = core::product(stream.pixel_aspect, {stream.width, stream.height});
    return fmt::format(" ({}:{})", whole.num, whole.den);
}

/// Names of the numbers of [H262, tables 6-7 to 6-9], sRGB's and those of high dynamic range.
std::string colour_text(const av::StreamFacts& s) {
    const auto named = [](int number, bool is_curve) {
        if (number == 1) return std::string("BT.709");
        if (number == 5 || number == 6) return std::string("BT.601");
        if (number == 9 && !is_curve) return std::string("BT.2020");
        if (number == 13 && is_curve) return std::string("sRGB");
        if (number == 16 && is_curve) return std::string("PQ");
        if (number == 18 && is_curve) return std::string("HLG");
        return number == 0 ? std::string("not said") : fmt::format("number {}", number);
    };
    std::string text = fmt::format("primaries {}, transfer {}, matrix {}", named(s.color_primaries, false),
                                   named(s.transfer_characteristics, true), named(s.matrix_coefficients, false));
    if (s.peak > 0) text += fmt::format("; made for white of {:.0f} cd/m2", s.peak);
    if (s.light.most > 0)
        text +=
            fmt::format(", brightest {:.0f} (MaxCLL), on average at most {:.0f} (MaxFALL)", s.light.most, s.light.mean);
    return text;
}

/// The most bits of a second of the film, in the order of its stream.
double busiest_second(const av::Inspection& film) {
    std::vector<std::int64_t> bits(film.pictures.size());
    for (const av::PictureFacts& p : film.pictures)
        if (p.coded >= 0 && p.coded < std::ssize(bits)) bits[static_cast<std::size_t>(p.coded)] = 8 * p.bytes;
    const auto length = static_cast<std::size_t>(std::lround(film.stream.rate.value()));
    if (length == 0) return 0;
    std::int64_t most = 0, sum = 0;
    for (std::size_t i = 0; i < bits.size(); ++i) {
        sum += bits[i] - (i >= length ? bits[i - length] : 0);
        most = std::max(most, sum);
    }
    return static_cast<double>(most);
}

/// What kind of device does not play the film, and a rate beyond its level.
std::string device_lines(const av::Inspection& film) {
    const av::StreamFacts& s = film.stream;
    std::string not_on(encoder::facts_of(s.codec).not_on);
    if (s.codec == encoder::Codec::h264) {
        const bool usual =
            s.profile.find("Baseline") != std::string::npos || s.profile == "Main" || s.profile == "High";
        if (!usual)
            not_on = "browsers, phones, televisions: they play 8 bits of 4:2:0";
        else if (s.level > "4.1")
            not_on = "players of up to 1080 lines at 30 Hz, which end at level 4.1 (many televisions, Blu-ray)";
    }
    const bool is_hdr = s.transfer_characteristics == 16 || s.transfer_characteristics == 18;
    if (is_hdr)
        not_on += std::string(not_on.empty() ? "" : ", ") + "displays without high dynamic range as it is meant";
    std::string text = fmt::format(
        "  devices    {}\n",
        not_on.empty() ? "whatever plays " + std::string(encoder::facts_of(s.codec).name) : "not on " + not_on);
    // High profile's bits are a fourth more than those of the profiles below.
    const bool is_low = s.codec == encoder::Codec::h264 && s.profile != "High";
    const std::int64_t most = av::bits_of_level(s.codec, s.level) * (is_low ? 4 : 5) / 5;
    if (const double bits = busiest_second(film); most > 0 && bits > static_cast<double>(most))
        text += fmt::format("  beyond     level {}: a second of it has {:.1f} Mb, the level {:.1f}\n", s.level,
                            1e-6 * bits, 1e-6 * static_cast<double>(most));
    return text;
}

/// What a player is told to wrap the pictures about its viewer by.
std::string sphere_text(const encoder::SphereBounds& sphere) {
    return fmt::format("  projection equirectangular, {:.4g} by {:.4g} degrees\n",
                       360 * (1 - sphere.left - sphere.right), 180 * (1 - sphere.top - sphere.bottom));
}

std::string stream_lines(const std::string& name, const av::Inspection& film) {
    const av::StreamFacts& s = film.stream;
    const double seconds = duration_of(film);
    const auto bytes = static_cast<double>(coded_bytes(film));
    std::string text = fmt::format("{}: {}", name, encoder::facts_of(s.codec).name);
    if (encoder::facts_of(s.codec).master)
        text += s.profile.empty() ? "" : " " + s.profile;
    else if (!s.profile.empty() || !s.level.empty())
        text += fmt::format(" {}@{}", s.profile.empty() ? "?" : s.profile, s.level.empty() ? "?" : s.level);
    text += fmt::format(", {}x{}{} at {:.5g} Hz, {}, {:.2f} s\n", s.width, s.height, shape_text(s), s.rate.value(),
                        pictures_text(static_cast<std::int64_t>(film.pictures.size())), seconds);
    text += fmt::format("  container  {}, {} stream{}\n", s.container, s.streams, s.streams == 1 ? "" : "s");
    if (s.sphere) text += sphere_text(*s.sphere);
    if (s.packing != core::FramePacking::none) text += fmt::format("  eyes       two, {}\n", core::name_of(s.packing));
    if (!s.title.empty()) text += fmt::format("  title      {}\n", s.title);
    if (!s.timecode.empty()) text += fmt::format("  timecode   {}\n", s.timecode);
    if (s.chapters > 0) text += fmt::format("  chapters   {}\n", s.chapters);
    text += fmt::format("  pictures   {}, {:.0f} kb/s", size_text(bytes), 8e-3 * ratio_of(bytes, seconds));
    if (s.bit_rate > 0) text += fmt::format("; declared: {:.0f} kb/s", 1e-3 * static_cast<double>(s.bit_rate));
    if (s.buffer_bits > 0) text += fmt::format(", buffer of {} bits", s.buffer_bits);
    const Groups groups = groups_of(film);
    text += fmt::format("\n  groups     {}, of {} at most\n", groups.count, pictures_text(groups.longest));
    text += fmt::format("  colours    {}\n", colour_text(s)) + device_lines(film);
    const auto interlaced = std::ranges::count_if(film.pictures, &av::PictureFacts::interlaced);
    if (interlaced > 0) text += fmt::format("  fields     {} interlaced\n", pictures_text(interlaced));
    const auto repeating = std::ranges::count_if(
        film.pictures, [](int fields) { return fields > 0; }, &av::PictureFacts::repeated_fields);
    if (repeating > 0)
        text += fmt::format("  repeats    {} {} shown for more than two fields\n", pictures_text(repeating),
                            repeating == 1 ? "is" : "are");
    if (film.unshown > 0)
        text += fmt::format("  not shown  {}: broken, or what they refer to is missing\n", pictures_text(film.unshown));
    return text;
}

std::string quantiser_text(double mean, double low, double high) {
    if (mean == 0) return fmt::format("{:>5} {:>6}", "-", "");
    return fmt::format("{:>5.1f} {:>6}", mean, low == high ? "" : fmt::format("{:g}-{:g}", low, high));
}

std::string vector_text(const av::VectorFacts& v) {
    const auto length = [&](double pixels) { return v.moving > 0 ? fmt::format("{:.1f}", pixels) : "-"; };
    return fmt::format("{:>4} {:>5} {:>5}", v.share > 0 ? fmt::format("{:.0f}%", 100 * v.share) : "-", length(v.mean),
                       length(v.longest));
}

/// Heading of both kinds of rows, 80 columns.
std::string heading(const std::string& left) {
    return fmt::format("\n{:>38} {:>5}  {:<16}  {}\n{:>25} {:>12} {:>5}  {:>4} {:>5} {:>5}  {:>4} {:>5} {:>5}\n",
                       "quantiser", "", "from before, px", "from after, px", left, "mean  range", "intra", "part",
                       "mean", "most", "part", "mean", "most");
}

/// Decoders of HEVC and AV1 tell no prediction.
bool tells_prediction(const av::Inspection& film) {
    return encoder::facts_of(film.stream.codec).tells_blocks;
}

std::string row(const std::string& left, const std::string& quantiser, std::optional<double> intra,
                const av::VectorFacts& forward, const av::VectorFacts& backward) {
    return fmt::format("{:>25} {} {:>5}  {}  {}\n", left, quantiser, intra ? fmt::format("{:.0f}%", 100 * *intra) : "-",
                       vector_text(forward), vector_text(backward));
}

std::optional<double> told(const av::Inspection& film, double intra) {
    return tells_prediction(film) ? std::optional(intra) : std::nullopt;
}

std::string picture_table(const av::Inspection& film) {
    std::string text = heading("number  coded type  bytes");
    for (const av::PictureFacts& p : film.pictures) {
        text += row(fmt::format("{:>6} {:>6} {:>3}  {:>6}", p.number, p.coded, p.type, p.bytes),
                    quantiser_text(p.mean_quantiser, p.min_quantiser, p.max_quantiser), told(film, p.intra), p.forward,
                    p.backward);
        if (!p.damage.empty()) text += fmt::format("{:>17} {}\n", "damaged:", p.damage);
    }
    return text;
}

std::string type_table(const av::Inspection& film) {
    const auto all = static_cast<double>(coded_bytes(film));
    std::string text = heading("type pictures  bytes part");
    for (const CodedType& t : coded_types(film))
        text += row(
            fmt::format("{:>4} {:>8} {:>6.0f} {:>3.0f}%", t.type, t.pictures,
                        static_cast<double>(t.bytes) / static_cast<double>(t.pictures), 100 * ratio_of(t.bytes, all)),
            quantiser_text(t.quantiser, t.min_quantiser, t.max_quantiser), told(film, t.intra), t.forward, t.backward);
    return text;
}

json vectors_json(const av::VectorFacts& v) {
    return {{"share", v.share}, {"moving", v.moving}, {"mean", v.mean}, {"longest", v.longest}};
}

json picture_json(const av::PictureFacts& p, bool tells) {
    return {{"picture", p.number},
            {"coded", p.coded},
            {"type", std::string(1, p.type)},
            {"bytes", p.bytes},
            {"position", p.position < 0 ? json(nullptr) : json(p.position)},
            {"random_access", p.random_access},
            {"interlaced", p.interlaced},
            {"top_field_first", p.top_field_first},
            {"repeated_fields", p.repeated_fields},
            {"quantiser", {{"mean", p.mean_quantiser}, {"min", p.min_quantiser}, {"max", p.max_quantiser}}},
            {"intra", tells ? json(p.intra) : json(nullptr)},
            {"forward", vectors_json(p.forward)},
            {"backward", vectors_json(p.backward)},
            {"damage", text_or_null(p.damage)}};
}

json json_of(const std::string& name, const av::Inspection& film, bool summary) {
    const av::StreamFacts& s = film.stream;
    const Groups groups = groups_of(film);
    const auto or_null = [](const auto& value, bool known) { return known ? json(value) : json(nullptr); };
    json types = json::object();
    for (const CodedType& t : coded_types(film))
        types[std::string(1, t.type)] = {
            {"pictures", t.pictures},
            {"bytes", t.bytes},
            {"quantiser", {{"mean", t.quantiser}, {"min", t.min_quantiser}, {"max", t.max_quantiser}}},
            {"intra", or_null(t.intra, tells_prediction(film))},
            {"forward", vectors_json(t.forward)},
            {"backward", vectors_json(t.backward)}};
    const double seconds = duration_of(film);
    const std::int64_t bytes = coded_bytes(film);
    json result{
        {"file", name},
        {"codec", encoder::facts_of(s.codec).word},
        {"container", s.container},
        {"streams", s.streams},
        {"profile", text_or_null(s.profile)},
        {"level", text_or_null(s.level)},
        {"width", s.width},
        {"height", s.height},
        {"fps", or_null(s.rate.value(), s.rate.num > 0)},
        {"pixel_aspect", or_null(json{s.pixel_aspect.num, s.pixel_aspect.den}, s.pixel_aspect.num > 0)},
        {"color_primaries", or_null(s.color_primaries, s.color_primaries > 0)},
        {"transfer_characteristics", or_null(s.transfer_characteristics, s.transfer_characteristics > 0)},
        {"matrix_coefficients", or_null(s.matrix_coefficients, s.matrix_coefficients > 0)},
        {"peak", or_null(s.peak, s.peak > 0)},
        {"max_cll", or_null(s.light.most, s.light.most > 0)},
        {"max_fall", or_null(s.light.mean, s.light.most > 0)},
        {"panorama", s.sphere ? json{s.sphere->left, s.sphere->top, s.sphere->right, s.sphere->bottom} : json()},
        {"stereo", s.packing != core::FramePacking::none ? json(std::string(core::name_of(s.packing))) : json()},
        {"title", text_or_null(s.title)},
        {"timecode", text_or_null(s.timecode)},
        {"chapters", s.chapters},
        {"busiest_second", busiest_second(film)},
        {"max_rate", or_null(s.bit_rate, s.bit_rate > 0)},
        {"vbv_bits", or_null(s.buffer_bits, s.buffer_bits > 0)},
        {"pictures", film.pictures.size()},
        {"seconds", seconds},
        {"bytes", bytes},
        {"average", ratio_of(8 * bytes, seconds)},
        {"groups", {{"count", groups.count}, {"longest", groups.longest}}},
        {"not_shown", film.unshown},
        {"damaged", damaged(film)},
        {"damage", film.damage},
        {"types", types}};
    if (!summary) {
        result["per_picture"] = json::array();
        for (const av::PictureFacts& picture : film.pictures)
            result["per_picture"].push_back(picture_json(picture, tells_prediction(film)));
    }
    return result;
}

/// Pictures not shown although their references are there: not those before the first shown picture, nor its B
/// pictures.
std::int64_t missing(const av::Inspection& film) {
    std::set<std::int64_t> shown;
    for (const av::PictureFacts& picture : film.pictures) shown.insert(picture.coded);
    if (shown.empty()) return 0;
    const auto all = static_cast<std::int64_t>(film.pictures.size()) + film.unshown;
    std::int64_t begin = *shown.begin() + 1;
    while (begin < all && !shown.contains(begin)) ++begin;
    if (begin == all) begin = *shown.begin() + 1;
    std::int64_t count = 0;
    for (std::int64_t n = begin; n < all; ++n) count += shown.contains(n) ? 0 : 1;
    return count;
}

/// One line about damage; empty where there is none.
std::string damage_line(const std::string& name, const av::Inspection& film) {
    if (film.pictures.empty()) return fmt::format("{}: not one picture can be decoded", name);
    const std::int64_t count = damaged(film);
    const auto first = std::ranges::find_if(film.pictures, &is_damaged);
    if (first != film.pictures.end())
        return fmt::format("{}: {} {} damaged, the first is number {}: {}", name, pictures_text(count),
                           count == 1 ? "is" : "are", first->number, first->damage);
    if (!film.damage.empty()) return fmt::format("{}: {}", name, film.damage.front());
    const std::int64_t lost = missing(film);
    return lost == 0 ? "" : fmt::format("{}: {} cannot be shown", name, pictures_text(lost));
}

/// Separator that neither names nor decoders' messages hold.
constexpr char end_of_damage = '\0';

}  // namespace

std::string info_of(const InfoOptions& options) {
    const std::string name = options.input.string();
    const av::Inspection film = av::inspect(options.input);
    std::string text = damage_line(name, film) + end_of_damage;
    if (options.json) return text + json_text(json_of(name, film, options.summary));
    text += stream_lines(core::printable(name), film);
    if (!options.summary) text += picture_table(film);
    return text + type_table(film);
}

namespace {

std::string probed(const InfoOptions& options) {
    std::vector<std::string> words{"info", options.input.string()};
    if (options.json) words.emplace_back("json");
    if (options.summary) words.emplace_back("summary");
    return scene::read_in_probe(words, options.input.string(), film_limits(options.input));
}

}  // namespace

int info(const InfoOptions& options) {
    if (const std::string why = not_a_film(options.input); !why.empty())
        throw core::Error("reading", options.input.string(), why);
    const std::string text = scene::Probe::is_possible() ? probed(options) : info_of(options);
    const std::size_t end = text.find(end_of_damage);
    const std::string damage = text.substr(0, end);
    print(text.substr(end + 1));
    if (damage.empty()) return 0;
    print_error(damage);
    return 1;
}

}  // namespace render2mpeg::app
