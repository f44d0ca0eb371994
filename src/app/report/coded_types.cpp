#include "app/report/coded_types.h"

#include <algorithm>
#include <numeric>

#include "core/numeric.h"

namespace render2mpeg::app {
namespace {

/// Adds a picture's vectors to those of its type: shares as sums, lengths weighted by what moves.
void add(av::VectorFacts& sum, const av::VectorFacts& picture) {
    sum.share += picture.share;
    sum.mean += picture.mean * picture.moving;
    sum.moving += picture.moving;
    sum.longest = std::max(sum.longest, picture.longest);
}

void finish(av::VectorFacts& sum, double pictures) {
    sum.mean = core::divide_or(sum.mean, sum.moving, 0.0);
    sum.share = core::divide_or(sum.share, pictures, 0.0);
    sum.moving = core::divide_or(sum.moving, pictures, 0.0);
}

}  // namespace

std::vector<CodedType> coded_types(const av::Inspection& film) {
    std::vector<CodedType> types(4);
    for (std::size_t i = 0; i < types.size(); ++i) types[i].type = "IPB?"[i];
    for (const av::PictureFacts& picture : film.pictures) {
        auto type =
            std::find_if(types.begin(), types.end(), [&](const CodedType& t) { return t.type == picture.type; });
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
    std::sort(starts.begin(), starts.end());
    starts.push_back(pictures);
    Groups groups{static_cast<std::int64_t>(starts.size()) - 1, 0};
    for (std::size_t i = 1; i < starts.size(); ++i)
        groups.longest = std::max(groups.longest, starts[i] - starts[i - 1]);
    return groups;
}

}  // namespace render2mpeg::app
