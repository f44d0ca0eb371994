#include "app/files/build_identity.h"

#include <elf.h>
#include <fmt/format.h>
#include <link.h>

#include <cstdint>
#include <cstring>

namespace render2mpeg::app {
namespace {

/// Sizes in notes are of whole words.
std::size_t in_words(std::size_t bytes) {
    return (bytes + 3) & ~std::size_t{3};
}

/// Takes the GNU build id out of a segment of notes. [ELF, "Note Section"]
std::string build_id_in(const std::uint8_t* notes, std::size_t size) {
    ElfW(Nhdr) note;
    for (std::size_t at = 0; at + sizeof note <= size;) {
        std::memcpy(&note, notes + at, sizeof note);
        const std::size_t name = at + sizeof note, content = name + in_words(note.n_namesz);
        const std::size_t next = content + in_words(note.n_descsz);
        if (next > size) break;
        if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == 4 && std::memcmp(notes + name, "GNU", 4) == 0) {
            std::string text;
            for (std::size_t i = 0; i < note.n_descsz; ++i) text += fmt::format("{:02x}", notes[content + i]);
            return text;
        }
        at = next;
    }
    return {};
}

/// Called with the program itself first, of all that is loaded; 1 ends the round.
int look_at_program(dl_phdr_info* object, std::size_t, void* text) {
    for (int i = 0; i < object->dlpi_phnum; ++i) {
        const ElfW(Phdr)& header = object->dlpi_phdr[i];
        if (header.p_type != PT_NOTE) continue;
        const auto* notes = reinterpret_cast<const std::uint8_t*>(object->dlpi_addr + header.p_vaddr);
        std::string found = build_id_in(notes, header.p_memsz);
        if (!found.empty()) *static_cast<std::string*>(text) = std::move(found);
    }
    return 1;
}

}  // namespace

std::string build_identity() {
    std::string text;
    dl_iterate_phdr(look_at_program, &text);
    return text;
}

}  // namespace render2mpeg::app
