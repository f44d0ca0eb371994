#include "app/options/option_row.h"

namespace render2mpeg::app {

OptionRow::OptionRow(const char* names, const char* group, Member member, const char* text, const Mark& first,
                     const Mark& second, const Mark& third, const Mark& fourth)
    : names(names), group(group), text(text), member(member) {
    struct Note {
        OptionRow& row;
        void operator()(std::monostate /*none*/) const {}
        void operator()(const char* values) const { row.values = values; }
        void operator()(Words words) const { row.words = words.all; }
        void operator()(Range range) const { row.range = range; }
        void operator()(const Parser& parser) const { row.parser = parser; }
        void operator()(Shown /*its default*/) const { row.is_shown = true; }
        void operator()(ShownAs shown) const { row.shown_as = shown.text; }
        void operator()(Required /*always*/) const { row.is_required = true; }
        void operator()(NotWith excluded) const { row.not_with.emplace_back(excluded.other); }
        void operator()(With needed) const { row.with = needed.other; }
        void operator()(TwoWords /*no more*/) const { row.is_two_words = true; }
        void operator()(Idle when) const { row.idle = when; }
    };
    for (const Mark* mark : {&first, &second, &third, &fourth}) std::visit(Note{*this}, *mark);
}

OptionRow::OptionRow(const char* names, const char* group, Parser parser, const char* text, const Mark& first,
                     const Mark& second, const Mark& third)
    : OptionRow(names, group, Member(), text, std::move(parser), first, second, third) {}

std::string OptionRow::id() const {
    const std::string all = names;
    return all.substr(all.find(',') + 1);
}

std::string OptionRow::name() const {
    return id().substr(0, id().find('@'));
}

}  // namespace render2mpeg::app
