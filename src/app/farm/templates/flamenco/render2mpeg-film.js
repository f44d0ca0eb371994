const JOB_TYPE = {
    label: "render2mpeg film",
    description: "Parts of a film that `render2mpeg farm` has planned, and the join behind them",
    settings: [
        { key: "program", type: "string", default: "render2mpeg", required: true },
        { key: "plan", type: "string", subtype: "dir_path", required: true },
        { key: "parts", type: "int32", default: 1, required: true },
    ],
};

function compileJob(job) {
    const settings = job.settings;
    const join = author.Task("join", "misc");
    join.addCommand(author.Command("exec", { exe: settings.program, args: ["join", settings.plan] }));
    for (let part = 1; part <= settings.parts; part++) {
        const task = author.Task("part-" + part, "misc");
        task.addCommand(author.Command("exec", { exe: settings.program, args: ["part", settings.plan, String(part)] }));
        join.addDependency(task);
        job.addTask(task);
    }
    job.addTask(join);
}
