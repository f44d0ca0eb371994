#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "app/options/option_text.h"
#include "farm/farm_film.h"

/// Job files are what schedulers take.
namespace render2mpeg {
namespace {

using nlohmann::json;
using support::contents;
using support::run;
using test::FarmFilm;

/// A plan of four parts for each scheduler.
class JobFiles : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        film_ = new FarmFilm("", 240);
        for (const std::string_view scheduler : app::scheduler_names) {
            const auto planned =
                film_->farm("-o " + film_->path(std::string(scheduler) + ".mpg"), "--to " + std::string(scheduler));
            ASSERT_EQ(planned.status, 0) << planned.output;
        }
    }
    static void TearDownTestSuite() {
        delete film_;
        film_ = nullptr;
    }
    static std::filesystem::path file(const std::string& scheduler, const std::string& name) {
        return *film_ / (scheduler + ".mpg.farm/" + name);
    }
    static json parsed(const std::string& scheduler, const std::string& name) {
        return json::parse(contents(file(scheduler, name)));
    }
    static FarmFilm* film_;
};
FarmFilm* JobFiles::film_ = nullptr;

TEST_F(JobFiles, AreScriptsThatAShellReads) {
    int scripts = 0;
    for (const std::string_view scheduler : app::scheduler_names)
        for (const auto& entry : std::filesystem::directory_iterator(file(std::string(scheduler), ""))) {
            if (!contents(entry.path()).starts_with("#!/bin/bash")) continue;
            const auto checked = run("bash -n " + entry.path().string());
            EXPECT_EQ(checked.output, "") << entry.path();
            EXPECT_EQ(contents(entry.path()).find("{{"), std::string::npos) << entry.path();
            ++scripts;
        }
    EXPECT_EQ(scripts, 12);
}

/// What a job template of version 2023-09 may have [OpenJD, 1.1, 2, 3].
void expect_keys(const json& object, const std::set<std::string>& known, const std::set<std::string>& needed) {
    ASSERT_TRUE(object.is_object()) << object;
    for (const auto& [name, value] : object.items()) EXPECT_TRUE(known.contains(name)) << name << " in " << object;
    for (const std::string& name : needed) EXPECT_TRUE(object.contains(name)) << name << " in " << object;
}

TEST_F(JobFiles, AreAnOpenJobDescription) {
    const json t = parsed("openjd", "template.json");
    expect_keys(t, {"specificationVersion", "name", "parameterDefinitions", "steps"},
                {"specificationVersion", "name", "steps"});
    EXPECT_EQ(t["specificationVersion"], "jobtemplate-2023-09");
    for (const json& parameter : t["parameterDefinitions"])
        expect_keys(parameter, {"name", "type", "objectType", "dataFlow", "default"}, {"name", "type"});
    ASSERT_EQ(t["steps"].size(), 2u);
    const json &parts = t["steps"][0], &join = t["steps"][1];
    expect_keys(parts, {"name", "parameterSpace", "script"}, {"name", "parameterSpace", "script"});
    EXPECT_EQ(parts["parameterSpace"]["taskParameterDefinitions"],
              json::array({{{"name", "Part"}, {"type", "INT"}, {"range", "1-4"}}}));
    EXPECT_EQ(parts["script"]["actions"]["onRun"]["args"],
              (json{"part", "{{Param.Plan}}", "{{Task.Param.Part}}", "--progress", "openjd"}));
    EXPECT_EQ(join["dependencies"], json::array({{{"dependsOn", "Parts"}}}));
    EXPECT_EQ(join["script"]["actions"]["onRun"]["args"], (json{"join", "{{Param.Plan}}"}));
}

TEST_F(JobFiles, AreIndexedJobsOfKubernetes) {
    const json parts = parsed("kubernetes", "parts.json"), join = parsed("kubernetes", "join.json");
    for (const json& job : {parts, join}) {
        EXPECT_EQ(job["apiVersion"], "batch/v1");
        EXPECT_EQ(job["kind"], "Job");
        const json& pod = job["spec"]["template"]["spec"];
        EXPECT_EQ(pod["restartPolicy"], "Never");
        ASSERT_TRUE(pod["containers"].is_array() && pod["volumes"].is_array());
        EXPECT_TRUE(pod["containers"][0]["volumeMounts"].is_array());
        EXPECT_EQ(pod["containers"][0]["volumeMounts"][0]["name"], pod["volumes"][0]["name"]);
        // A name of an object [RFC 1123].
        const auto name = job["metadata"]["name"].get<std::string>();
        EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-"), std::string::npos) << name;
    }
    EXPECT_EQ(parts["spec"]["completionMode"], "Indexed");
    EXPECT_EQ(parts["spec"]["completions"], 4);
    EXPECT_EQ(parts["spec"]["podFailurePolicy"]["rules"][0]["onExitCodes"]["values"], (json{2, 3}));
    EXPECT_TRUE(parts["spec"]["podFailurePolicy"]["rules"][1]["onPodConditions"].is_array());
}

TEST_F(JobFiles, AreAJobOfFlamenco) {
    const json job = parsed("flamenco", "job.json");
    EXPECT_EQ(job["settings"]["parts"], 4);
    EXPECT_EQ(job["type"], "render2mpeg-film");
    EXPECT_NE(contents(file("flamenco", "render2mpeg-film.js")).find("function compileJob(job)"), std::string::npos);
}

TEST_F(JobFiles, AreRunBySnakemakeSlow) {
    if (run("command -v snakemake").status != 0) GTEST_SKIP() << "there is no snakemake";
    const auto run_dry = run("bash " + file("snakemake", "submit.sh").string() + " --dry-run");
    EXPECT_EQ(run_dry.status, 0) << run_dry.output;
    EXPECT_NE(run_dry.output.find("\npart         4"), std::string::npos) << run_dry.output;
}

TEST_F(JobFiles, AreRunByGnuParallelSlow) {
    if (run("command -v parallel").status != 0) GTEST_SKIP() << "there is no GNU parallel";
    ASSERT_EQ(film_->render("-o " + film_->path("one.mpg")).status, 0);
    const auto made = run("bash " + file("parallel", "submit.sh").string());
    EXPECT_EQ(made.status, 0) << made.output;
    EXPECT_TRUE(film_->same("one.mpg", "parallel.mpg"));
}

}  // namespace
}  // namespace render2mpeg
