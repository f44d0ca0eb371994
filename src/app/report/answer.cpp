#include "app/report/answer.h"

#include <fmt/format.h>

#include "app/report/figures.h"
#include "app/system/progress.h"

namespace render2mpeg::app {
namespace {

constexpr const char* grades[] = {"good", "fair", "poor", "plain"};

std::string row_of(const AnswerRow& row) {
    const std::string badge = row.recommended ? " <span class=\"badge\">take this</span>" : "";
    const std::string bar = row.bar.empty() ? ""
                                            : fmt::format("<div class=\"len\" style=\"width:{:.1f}%\"></div>{}",
                                                          100 * row.share, escaped(row.bar));
    const std::string note = row.note.empty() ? "" : "<br/><small>" + escaped(row.note) + "</small>";
    return fmt::format(
        "<tr{}><td>{}{}{}</td><td class=\"bars\">{}</td><td><span class=\"{}\">{}</span><br/><small>{}</small></td>"
        "<td>{}</td></tr>\n",
        row.recommended ? " class=\"taken\"" : "", escaped(row.name), badge, note, bar,
        grades[static_cast<int>(row.grade)], escaped(row.word), escaped(row.detail),
        row.picture.empty() ? escaped(row.size) : row.picture);
}

}  // namespace

std::optional<std::size_t> cheapest_alike(std::span<const Offer> offers) {
    std::optional<std::size_t> taken;
    for (std::size_t i = 0; i < offers.size(); ++i)
        if (offers[i].is_like_best && (!taken || offers[i].cost < offers[*taken].cost)) taken = i;
    return taken;
}

std::string time_text(double clock, double cpu) {
    return fmt::format("{} ({:.{}f} s of CPU)", clock_text(clock), cpu, cpu < 10 ? 1 : 0);
}

std::string answer_table(const AnswerHeads& heads, const std::vector<AnswerRow>& rows, const std::string& note) {
    if (rows.empty()) return {};
    std::string text = "<table class=\"answer\">\n<tr>";
    for (const std::string& head : {heads.name, heads.bar, heads.word, heads.size})
        text += "<th>" + escaped(head) + "</th>";
    text += "</tr>\n";
    for (const AnswerRow& row : rows) text += row_of(row);
    return text + "</table>\n<p class=\"soft\">" + escaped(note) + "</p>\n";
}

std::string answer_screen(const std::string& table, const std::string& figure, const std::string& command) {
    std::string text = "<div class=\"screen\"><div>" + table + "</div><div>" + figure + "</div></div>\n";
    if (!command.empty()) text += "<h2>Do it</h2>\n<pre>" + escaped(command) + "</pre>\n";
    return text;
}

std::string html_table(const std::string& title, std::string_view kinds, const std::vector<std::string>& heads,
                       const std::vector<TableRow>& rows) {
    const auto number = [&](std::size_t column) { return kinds[column] == 'n' ? " class=\"n\"" : ""; };
    std::string text = "<h2>" + escaped(title) + "</h2>\n<div class=\"wide\"><table>\n";
    if (!heads.empty()) text += "<tr>";
    for (std::size_t i = 0; i < heads.size(); ++i) text += fmt::format("<th{}>{}</th>", number(i), escaped(heads[i]));
    if (!heads.empty()) text += "</tr>\n";
    for (const TableRow& row : rows) {
        text += row.faint ? "<tr class=\"off\">" : "<tr>";
        for (std::size_t i = 0; i < row.cells.size(); ++i) {
            const std::string cell = escaped(row.cells[i]);
            if (kinds[i] == 'b')
                text += "<td class=\"bar\"><div class=\"one\" style=\"width:" + cell + "%\"></div></td>";
            else
                text += fmt::format("<td{}>{}</td>", number(i), row.bold && i == 0 ? "<b>" + cell + "</b>" : cell);
        }
        text += "</tr>\n";
    }
    return text + "</table></div>\n";
}

std::string folded(const std::string& title, const std::string& html) {
    return html.empty() ? "" : "<details><summary>" + escaped(title) + "</summary>\n" + html + "</details>\n";
}

}  // namespace render2mpeg::app
