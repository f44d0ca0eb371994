#include "app/production/preparation.h"

#include <string>
#include <vector>

#include "app/loop/memory_need.h"
#include "app/options/unused_options.h"
#include "app/system/memory_limit.h"
#include "app/system/probes.h"
#include "app/system/terminal.h"
#include "parallel/loops.h"

namespace render2mpeg::app {

RenderJob prepare_within_memory(const RenderOptions& options) {
    if (!options.memory) return prepare(options);
    const std::uint64_t limit = memory_from(*options.memory);
    hold_to(limit, parallel::thread_count());
    RenderJob film = prepare(options);
    if (!probe_images(*film.animation, image_probes(true))) return film;
    // Their headers may be read now.
    film.images_in_turn = !may_decode_at_once(film, memory_need(film), limit, parallel::thread_count());
    return film;
}

void print_notes(const RenderJob& film, const RenderOptions& options) {
    if (options.quiet) return;
    std::vector<std::string> notes = film.animation->notes;
    for (const std::string& line : unused_options(options, film.kind, film.tolerance)) notes.push_back(line);
    notes.push_back(film.kind == OutputKind::film ? unused_keyframes(film.keyframes, film.frames) : "");
    notes.push_back(film.kind == OutputKind::film ? keyframes_without_chapter(film.film()) : "");
    for (const std::string& note : notes)
        if (!note.empty()) print_line(note);
}

}  // namespace render2mpeg::app
