#include "checks/tree.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <sstream>

namespace render2mpeg::checks {
namespace {

namespace fs = std::filesystem;

/// Splits C++ into code and comments. A scanner, not a parser: literals, comments and raw strings are all it knows.
class Splitter {
  public:
    explicit Splitter(File& file) : text_(file.text), code_(file.code), comments_(file.comments) {
        code_.assign(text_.size(), ' ');
        comments_.assign(text_.size(), ' ');
        for (std::size_t i = 0; i < text_.size(); ++i)
            if (text_[i] == '\n') code_[i] = comments_[i] = '\n';
    }

    void run() {
        while (at_ < text_.size()) {
            if (begins("//"))
                take_comment(text_.find('\n', at_));
            else if (begins("/*"))
                take_comment(text_.find("*/", at_ + 2));
            else if (begins("R\"") && (at_ == 0 || !is_word(text_[at_ - 1])))
                take_raw_string();
            else if (text_[at_] == '"' || (text_[at_] == '\'' && (at_ == 0 || !is_word(text_[at_ - 1]))))
                take_literal(text_[at_]);
            else
                keep(1);
        }
    }

  private:
    bool begins(std::string_view what) const { return text_.compare(at_, what.size(), what) == 0; }

    void keep(std::size_t count) {
        for (; count > 0 && at_ < text_.size(); --count, ++at_) code_[at_] = text_[at_];
    }

    void take_comment(std::size_t end) {
        end = std::min(end, text_.size());
        for (at_ += 2; at_ < end; ++at_) comments_[at_] = text_[at_];
        if (begins("*/")) at_ += 2;
    }

    void take_raw_string() {
        const std::size_t open = text_.find('(', at_);
        if (open == std::string::npos) return keep(2);
        std::string close(1, ')');
        close.append(text_, at_ + 2, open - at_ - 2).append(1, '"');
        at_ = std::min(text_.size(), text_.find(close, open));
        at_ = std::min(text_.size(), at_ + close.size());
    }

    void take_literal(char quote) {
        // An #include's name is a literal that the checks read: keep it.
        const std::size_t line = text_.rfind('\n', at_) + 1;  // npos + 1 is 0, the first line
        const std::size_t hash = std::min(text_.find_first_not_of(' ', line), text_.size());
        const bool include = hash < at_ && text_[hash] == '#' && text_.find("include", hash) < at_;
        const std::size_t begin = at_;
        for (++at_; at_ < text_.size() && text_[at_] != quote && text_[at_] != '\n'; ++at_)
            if (text_[at_] == '\\') ++at_;
        at_ = std::min(text_.size(), at_ + 1);
        code_[begin] = quote;
        if (include)
            for (std::size_t i = begin; i < at_; ++i) code_[i] = text_[i];
        else if (text_[at_ - 1] == quote)
            code_[at_ - 1] = quote;
    }

    const std::string& text_;
    std::string& code_;
    std::string& comments_;
    std::size_t at_ = 0;
};

bool ends_with_any(std::string_view name, std::initializer_list<std::string_view> endings) {
    return std::any_of(endings.begin(), endings.end(), [&](std::string_view e) { return name.ends_with(e); });
}

bool is_text(const std::string& path) {
    const std::string name = fs::path(path).filename().string();
    return ends_with_any(name,
                         {".cpp", ".h", ".cmake", ".txt", ".md", ".json", ".gltf", ".obj", ".mtl", ".py", ".yml"}) ||
           path.starts_with("scripts/") || path.starts_with(".ci/") || name == ".clang-format" ||
           name == ".clang-tidy" || name == ".gitignore";
}

/// Folders that hold no sources of ours.
bool is_foreign(const std::string& folder) {
    return folder == ".git" || folder == ".cache" || folder == "out" || folder == "build" ||
           folder.starts_with("build-") || folder.starts_with("cmake-build") || folder.ends_with(".partial");
}

}  // namespace

bool is_word(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

bool File::is_cpp() const {
    return ends_with_any(path, {".cpp", ".h"});
}
bool File::is_product() const {
    return is_cpp() && !path.starts_with("tests/") && !path.starts_with("bench/");
}

std::ostream& operator<<(std::ostream& out, const Finding& finding) {
    out << finding.path;
    if (finding.line > 0) out << ':' << finding.line;
    return out << ": " << finding.message;
}

std::string list_of(const std::vector<Finding>& findings) {
    std::ostringstream out;
    for (const Finding& finding : findings) out << finding << '\n';
    return out.str();
}

File make_file(std::string path, std::string text) {
    File file{std::move(path), std::move(text), {}, {}};
    if (file.is_cpp())
        Splitter(file).run();
    else
        file.comments = file.text;
    return file;
}

std::vector<File> read_tree(const fs::path& root) {
    std::vector<File> files;
    for (auto it = fs::recursive_directory_iterator(root); it != fs::recursive_directory_iterator(); ++it) {
        const std::string path = it->path().lexically_relative(root).generic_string();
        if (it->is_directory() && is_foreign(it->path().filename().string())) it.disable_recursion_pending();
        if (!it->is_regular_file() || !is_text(path)) continue;
        std::ifstream in(it->path(), std::ios::binary);
        files.push_back(make_file(path, std::string(std::istreambuf_iterator<char>(in), {})));
    }
    std::sort(files.begin(), files.end(), [](const File& a, const File& b) { return a.path < b.path; });
    return files;
}

int line_at(std::string_view text, std::size_t offset) {
    return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(offset), '\n'));
}

std::vector<std::string_view> lines_of(std::string_view text) {
    std::vector<std::string_view> lines;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        lines.push_back(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return lines;
}

std::vector<std::size_t> find_word(std::string_view text, std::string_view word) {
    std::vector<std::size_t> found;
    for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
        const std::size_t end = at + word.size();
        const bool glued_before = at > 0 && is_word(text[at - 1]) && is_word(word.front());
        const bool glued_behind = end < text.size() && is_word(text[end]) && is_word(word.back());
        if (!glued_before && !glued_behind) found.push_back(at);
    }
    return found;
}

std::vector<Include> includes_of(const File& file) {
    std::vector<Include> includes;
    int line = 0;
    for (std::string_view text : lines_of(file.code)) {
        ++line;
        const std::size_t hash = text.find_first_not_of(' ');
        if (hash == std::string_view::npos || text[hash] != '#') continue;
        const std::size_t word = text.find("include", hash);
        const std::size_t open = text.find_first_of("<\"");
        if (word == std::string_view::npos || open == std::string_view::npos || open < word) continue;
        const std::size_t close = text.find(text[open] == '<' ? '>' : '"', open + 1);
        if (close == std::string_view::npos) continue;
        includes.push_back({std::string(text.substr(open + 1, close - open - 1)), text[open] == '"', line});
    }
    return includes;
}

}  // namespace render2mpeg::checks
