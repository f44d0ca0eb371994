#include "app/files/consent.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <string>
#include <system_error>

#include "app/options/output_kind.h"
#include "app/system/terminal.h"
#include "core/error.h"
#include "core/text.h"

namespace render2mpeg::app {
namespace {

/// Something that is not to be done without a word.
struct Question {
    std::filesystem::path file;
    std::string standing;  ///< what is so
    std::string question;  ///< whether to
    std::string cure;      ///< what -y does
};

bool holds_a_film(const std::filesystem::path& file) {
    std::error_code error;
    return std::filesystem::is_regular_file(file, error) && std::filesystem::file_size(file, error) > 0 && !error;
}

std::vector<Question> questions_of(const Wishes& wishes) {
    std::vector<Question> questions;
    std::vector<std::filesystem::path> all = wishes.beside;
    for (const Files& film : wishes.films) {
        all.push_back(film.name);
        if (!film.frames && holds_a_film(film.name))
            questions.push_back({film.name, "is there already", "Replace it?", "replaces it"});
        if (!film.frames) continue;
        const std::vector<std::int64_t> there = numbers_on_disk(film.name);
        const auto count = std::count_if(there.begin(), there.end(), [&](std::int64_t n) {
            return n >= film.frames->first && n <= film.frames->last;
        });
        if (count > 0)
            questions.push_back({film.name, fmt::format("{} of these images are there already", count), "Replace them?",
                                 "replaces them"});
    }
    std::vector<std::filesystem::path> folders;
    for (const std::filesystem::path& file : all) {
        std::error_code error;
        const std::filesystem::path folder = file.parent_path();
        if (file.empty() || folder.empty() || std::filesystem::exists(folder, error)) continue;
        if (std::find(folders.begin(), folders.end(), folder) != folders.end()) continue;
        folders.push_back(folder);
        questions.push_back({file, "there is no folder " + folder.string(), "Make it?", "makes it"});
    }
    return questions;
}

std::string line_of(const Question& q) {
    return q.file.string() + ": " + q.standing;
}

bool says_yes() {
    std::string answer;
    std::getline(std::cin, answer);
    return !answer.empty() && (answer[0] == 'y' || answer[0] == 'Y');
}

}  // namespace

void ask_consent(const Wishes& wishes, bool agreed) {
    if (agreed) return;
    const bool terminal = isatty(STDIN_FILENO) != 0 && isatty(STDERR_FILENO) != 0;
    for (const Question& q : questions_of(wishes)) {
        if (!terminal) throw core::Error("writing", q.file.string(), q.standing + "; -y " + q.cure);
        std::fputs((core::printable(line_of(q) + ". " + q.question) + " [y/N] ").c_str(), stderr);
        std::fflush(stderr);
        if (!says_yes()) throw core::Error("writing", q.file.string(), q.standing + ", and is left as it is");
    }
}

std::vector<std::string> questions_about(const Wishes& wishes) {
    std::vector<std::string> lines;
    for (const Question& q : questions_of(wishes)) lines.push_back(line_of(q) + "; -y " + q.cure);
    return lines;
}

}  // namespace render2mpeg::app
