#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <vector>

#include "app/farm/job_files.h"
#include "app/options/option_text.h"
#include "app/system/program.h"
#include "core/error.h"
#include "support/program.h"

/// No name of a folder becomes a command, an option or another path in a job file.
namespace render2mpeg {
namespace {

using nlohmann::json;
using support::contents;

struct Name {
    std::string text;
    bool is_taken = true;
};

/// Most would make a file PWNED where they are run.
const std::vector<Name>& hostile_names() {
    static const std::vector<Name> names{{"plain"},
                                         {"line\nbreak", false},
                                         {"evil\ntouch PWNED\n#", false},
                                         {"cr\rtouch PWNED", false},
                                         {"tab\ttab", false},
                                         {"bell\x07", false},
                                         {"escape\x1b[31m", false},
                                         {"delete\x7f", false},
                                         {"latin-\xe9", false},
                                         {"\xff\xfe", false},
                                         {"turned-\u202egpm.exe", false},
                                         {"separator-\u2028", false},
                                         {"quote'; touch PWNED; '"},
                                         {"quotes\"; touch PWNED; \""},
                                         {"$(touch PWNED)"},
                                         {"`touch PWNED`"},
                                         {"${x:=`touch PWNED`}"},
                                         {"$HOME"},
                                         {"$$(PATH)"},
                                         {"$'\\x41'"},
                                         {"; touch PWNED"},
                                         {"&& touch PWNED"},
                                         {"| touch PWNED"},
                                         {"> PWNED"},
                                         {"< PWNED"},
                                         {"(touch PWNED)"},
                                         {"-rf"},
                                         {"--wrap=touch PWNED"},
                                         {"a..b"},
                                         {"..."},
                                         {"~"},
                                         {"~root"},
                                         {"%j-%A-%%-%"},
                                         {"@plan@"},
                                         {"@places@@name@"},
                                         {"*?[a-z]!x^y"},
                                         {"# touch PWNED"},
                                         {"back\\slash\\"},
                                         {"\\"},
                                         {"  spaces  "},
                                         {"\u00fcml\u00e4ut \U0001f3ac"},
                                         {"{}"},
                                         {"{#}-{%}-{1}"},
                                         {"{= system \"touch PWNED\" =}"},
                                         {"{{Param.Program}}"},
                                         {"a=b,c:d"},
                                         {std::string(240, 'x')}};
    return names;
}

/// What PyOutline would send to Cuebot, as JSON beside the notes: commands are joined by blanks.
constexpr const char* outline_stand_in = R"py(
import json, os, types, sys
class Shell:
    def __init__(self, name, command, range, env, **more):
        self.says = {"name": name, "command": " ".join(command), "range": range, "env": env, "after": []}
    def depend_all(self, other):
        self.says["after"].append(other.says["name"])
class Outline:
    def __init__(self, name, shot, show, user):
        self.name, self.layers = name, []
    def add_layer(self, layer):
        self.layers.append(layer)
def launch(job, use_pycuerun):
    assert not use_pycuerun
    with open(os.environ["NOTES"] + ".json", "w") as file:
        json.dump({"name": job.name, "layers": [layer.says for layer in job.layers]}, file)
for name, more in {"cuerun": {"launch": launch}, "modules": {}, "modules.shell": {"Shell": Shell}}.items():
    module = sys.modules["outline." + name] = types.ModuleType("outline." + name)
    module.__dict__.update(more, __path__=[])
import outline
outline.cuerun, outline.modules = sys.modules["outline.cuerun"], sys.modules["outline.modules"]
outline.modules.shell = sys.modules["outline.modules.shell"]
)py";

/// A place with programs of schedulers that only note how they are called.
class Stage {
  public:
    Stage() {
        std::filesystem::create_directories(folder_ / "python/outline");
        std::ofstream(folder_ / "python/outline/__init__.py") << outline_stand_in;
        std::filesystem::create_directory(folder_ / "bin");
        for (const char* program :
             {"render2mpeg", "sbatch", "qsub", "kubectl", "curl", "openjd", "parallel", "snakemake"}) {
            std::ofstream(folder_ / "bin" / program)
                << "#!/bin/sh\nprintf '%s\\n' \"${0##*/}\" \"$@\" >> \"$NOTES\"\necho 1\ncase \"$*\" in *=failed*) "
                   "exit 1 ;; esac\n";
            std::filesystem::permissions(folder_ / "bin" / program, std::filesystem::perms::owner_all);
        }
    }
    std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }
    /// A plan of a film of this name below a folder of this name, which is made.
    app::FarmPlan plan(const std::string& name, const std::string& scheduler) const {
        app::FarmPlan plan;
        plan.folder = folder_ / scheduler / name / "film.mpg.farm";
        plan.scheduler = scheduler;
        plan.output_name = name + ".mpg";
        plan.parts = {{1, {0, 0}, {0, 59}}, {2, {1, 1}, {60, 119}}};
        std::filesystem::create_directories(plan.folder);
        return plan;
    }
    /// Runs words in a folder, and returns what the programs noted.
    std::string notes_of(const std::filesystem::path& where, const std::vector<std::string>& words,
                         bool own = true) const {
        const std::filesystem::path notes = folder_ / "notes";
        std::filesystem::remove(notes);
        std::vector<std::string> all{"env",
                                     "-C",
                                     where.string(),
                                     "NOTES=" + notes.string(),
                                     "SLURM_ARRAY_TASK_ID=2",
                                     "SGE_TASK_ID=2",
                                     "JOB_COMPLETION_INDEX=1",
                                     "PYTHONPATH=" + (folder_ / "python").string(),
                                     "PYTHONDONTWRITEBYTECODE=1",
                                     "RENDER2MPEG=" + (folder_ / "bin/render2mpeg").string()};
        if (own) all.push_back("PATH=" + (folder_ / "bin").string() + ":" + std::getenv("PATH"));
        all.insert(all.end(), words.begin(), words.end());
        const app::Finished finished = app::run_program(all, app::Output::caught);
        EXPECT_EQ(finished.status, 0) << finished.text;
        return contents(notes);
    }
    bool was_entered() const {
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path()))
            if (entry.path().filename() == "PWNED") return true;
        return false;
    }

  private:
    support::Folder folder_;
};

/// What schedulers read in comments, but for jobs' names of harmless letters.
std::string directives_in(const std::filesystem::path& folder) {
    static const std::regex job_name("r2m-[A-Za-z0-9._-]+");
    std::string found;
    for (const char* name : {"part.sbatch", "join.sbatch", "part.sge", "join.sge"}) {
        std::istringstream text(contents(folder / name));
        for (std::string line; std::getline(text, line);)
            if (line.starts_with("#")) found += std::regex_replace(line, job_name, "NAME") + "\n";
    }
    return found;
}

bool is_taken(const Name& name, const std::string& scheduler) {
    const std::map<std::string, const char*> replaced = {
        {"slurm", "%\\"}, {"sge", "$"}, {"flamenco", "{"}, {"kubernetes", ":"}};
    const auto by = replaced.find(scheduler);
    return name.is_taken && (by == replaced.end() || name.text.find_first_of(by->second) == std::string::npos);
}

void expect_refusal(const app::FarmPlan& plan) {
    try {
        check_job_files(plan);
        ADD_FAILURE() << plan.scheduler << " takes " << plan.folder;
    } catch (const core::Error& error) {
        EXPECT_NE(std::string(error.what()).find("rename it"), std::string::npos) << error.what();
    }
    EXPECT_TRUE(std::filesystem::is_empty(plan.folder));
}

/// The words that a part's or the join's command is called with.
std::string called(const std::string& command, const std::string& plan, const std::string& more = "") {
    return "render2mpeg\n" + command + "\n" + plan + "\n" + more;
}

/// What was sent to OpenCue, run as its hosts would: by a shell, after Cuebot has replaced its own names.
void expect_exact_layers(const Stage& stage, const app::FarmPlan& plan) {
    const json job = json::parse(contents(stage / "notes.json"));
    EXPECT_EQ(job["name"].get<std::string>().find_first_not_of(
                  "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_"),
              std::string::npos)
        << job["name"];
    ASSERT_EQ(job["layers"].size(), 2u);
    for (const json& layer : job["layers"]) {
        const bool is_join = layer["name"] == "join";
        EXPECT_EQ(layer["after"], is_join ? json::array({"parts"}) : json::array());
        EXPECT_EQ(layer["range"], is_join ? "1-1" : "1") << "the stand-in says that one part is left";
        std::string command = layer["command"];
        EXPECT_EQ(command.find(plan.folder.string()), std::string::npos);
        if (const std::size_t at = command.find("#IFRAME#"); at != command.npos) command.replace(at, 8, "2");
        EXPECT_EQ(command.find('#'), std::string::npos) << command;
        std::vector<std::string> words{"env"};
        for (const auto& [name, value] : layer["env"].items()) words.push_back(name + "=" + value.get<std::string>());
        for (const std::string& word : {std::string("sh"), std::string("-c"), command}) words.push_back(word);
        EXPECT_EQ(stage.notes_of("/", words),
                  called(is_join ? "join" : "part", plan.folder.string(), is_join ? "" : "2\n"));
    }
}

/// Runs all that a scheduler would run.
void expect_exact_calls(const Stage& stage, const app::FarmPlan& plan) {
    const std::string folder = plan.folder.string();
    const std::string submitted = stage.notes_of("/", {"bash", folder + "/submit.sh"});
    EXPECT_NE(submitted, "");
    for (const char* script : {"part.sbatch", "part.sge"})
        if (std::filesystem::exists(plan.folder / script)) {
            EXPECT_EQ(stage.notes_of("/", {"bash", folder + "/" + script}).find(called("part", folder, "2\n")), 0u);
        }
    for (const char* script : {"join.sbatch", "join.sge"})
        if (std::filesystem::exists(plan.folder / script)) {
            EXPECT_EQ(stage.notes_of("/", {"bash", folder + "/" + script}).find(called("join", folder)), 0u);
        }
    if (plan.scheduler == "parallel") {
        EXPECT_NE(submitted.find(called("join", folder)), std::string::npos);
        EXPECT_EQ(submitted.find(folder), submitted.rfind(folder)) << "the part's command holds no name";
    }
    const auto in = [&](const char* file) { return json::parse(contents(plan.folder / file)); };
    if (plan.scheduler == "kubernetes")
        for (const char* file : {"parts.json", "join.json"}) {
            const json container = in(file)["spec"]["template"]["spec"]["containers"][0];
            EXPECT_EQ(container["workingDir"], folder);
            EXPECT_EQ(container["volumeMounts"][0]["mountPath"], plan.folder.parent_path().string());
            std::string words;
            for (const json& word : container["command"]) words += word.get<std::string>() + "\n";
            EXPECT_EQ(words.find(folder), std::string::npos) << "Kubernetes replaces $(NAME) there";
            EXPECT_EQ(stage.notes_of(folder, container["command"].get<std::vector<std::string>>()),
                      called(file[0] == 'p' ? "part" : "join", ".", file[0] == 'p' ? "2\n" : ""));
        }
    if (plan.scheduler == "openjd") {
        EXPECT_EQ(in("template.json")["parameterDefinitions"][1]["default"], folder);
    }
    if (plan.scheduler == "flamenco") {
        EXPECT_EQ(in("job.json")["settings"]["plan"], folder);
    }
    if (plan.scheduler == "opencue") expect_exact_layers(stage, plan);
    if (plan.scheduler == "snakemake") {
        EXPECT_EQ(contents(plan.folder / "Snakefile").find(folder), std::string::npos);
    }
}

TEST(JobNames, NeverBecomeCommandsOptionsOrOtherPathsSlow) {
    const Stage stage;
    for (const std::string_view scheduler : app::scheduler_names) {
        const app::FarmPlan plain = stage.plan("plain", std::string(scheduler));
        write_job_files(plain);
        const std::string directives = directives_in(plain.folder);
        for (const Name& name : hostile_names()) {
            SCOPED_TRACE(std::string(scheduler) + " in a folder " + app::quoted(name.text));
            const app::FarmPlan plan = stage.plan(name.text, std::string(scheduler));
            if (!is_taken(name, plan.scheduler)) {
                expect_refusal(plan);
                continue;
            }
            write_job_files(plan);
            EXPECT_EQ(directives_in(plan.folder), directives);
            expect_exact_calls(stage, plan);
        }
    }
    EXPECT_FALSE(stage.was_entered());
}

TEST(JobNames, AreLeftAloneByGnuParallelSlow) {
    if (!app::is_installed("parallel")) GTEST_SKIP() << "there is no GNU parallel";
    const Stage stage;
    std::filesystem::remove(stage / "bin/parallel");
    for (const Name& name : hostile_names()) {
        if (!name.is_taken) continue;
        SCOPED_TRACE(name.text);
        const app::FarmPlan plan = stage.plan(name.text, "parallel");
        write_job_files(plan);
        const std::string folder = plan.folder.string(),
                          notes = stage.notes_of("/", {"bash", folder + "/submit.sh", "--jobs", "1"});
        EXPECT_EQ(notes, called("part", folder, "1\n--threads\n1\n") + called("part", folder, "2\n--threads\n1\n") +
                             called("join", folder));
    }
    EXPECT_FALSE(stage.was_entered());
}

}  // namespace
}  // namespace render2mpeg
