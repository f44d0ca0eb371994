#include "encoder_rd/foreign.h"

#include <algorithm>
#include <array>
#include <sstream>

#include "core/error.h"
#include "encoder_rd/ffmpeg_process.h"

namespace render2mpeg::bench {
namespace {

/// {S}: size as WxH, {s}: as W:H; {name.png}: a texture.
struct Source {
    const char* name;
    const char* words;
};
constexpr std::array<Source, 11> sources = {{
    // Fit set: a test pattern, a zoom into fine detail, a turning pan over print, grain over a slow pan, a camera that
    // shakes, slides that are cut and crossfaded.
    {"testsrc", "-f lavfi -i testsrc2=size={S}:rate=30"},
    {"mandelbrot", "-f lavfi -i mandelbrot=size={S}:rate=30:start_scale=0.3:end_scale=0.03:end_pts=120"},
    {"pan", "-loop 1 -framerate 30 -i {print.png} -vf scale=2048:-1,rotate=a=0.003*n,crop={s}:x=400+2.5*n:y=500+n"},
    {"film",
     "-loop 1 -framerate 30 -i {cloth.png} -vf "
     "scale=1400:-1,crop={s}:x=200+n:y=300,noise=alls=6:allf=t:all_seed=9"},
    {"shake",
     "-loop 1 -framerate 30 -i {tiles.png} -vf "
     "scale=1800:-1,rotate=a=0.02*sin(n),crop={s}:x=500+40*sin(0.9*n):y=400+25*sin(1.3*n)"},
    {"slides",
     "-loop 1 -framerate 30 -i {carpet.png} -loop 1 -framerate 30 -i {planks.png} -filter_complex "
     "[0]scale=1500:-1,crop={s}:x=100+n:y=200,trim=end_frame=9,setpts=PTS-STARTPTS,format=yuv420p,setsar=1[a];"
     "[1]scale=1500:-1,crop={s}:x=300:y=100+2*n,setpts=PTS-STARTPTS,format=yuv420p,setsar=1[b];"
     "[a][b]concat=n=2,fade=in:0:5"},
    // Test set: a zoom, grain over a sliding texture, soft colours, clutter that comes and goes, hard cuts and a fade.
    {"zoom",
     "-loop 1 -framerate 30 -i {planks.png} -vf "
     "scale=2600:-1,zoompan=z=1.4+0.006*on:x=500+3*on:y=400+on:d=1:s={S}:fps=30"},
    {"grain",
     "-loop 1 -framerate 30 -i {gravel.png} -vf "
     "scale=1600:-1,rotate=a=0.1-0.002*n,crop={s}:x=300+4*n:y=300,noise=c0s=7:c0f=t:all_seed=5"},
    {"gradients", "-f lavfi -i gradients=size={S}:rate=30:speed=0.02:nb_colors=6:seed=7"},
    {"life",
     "-f lavfi -i life=size=160x90:rate=30:mold=12:ratio=0.15:seed=3:death_color=#20304a:life_color=#f0e8d0 -vf "
     "scale={s}:flags=bicubic"},
    {"cuts",
     "-loop 1 -framerate 30 -i {marble.png} -loop 1 -framerate 30 -i {bricks.png} -f lavfi -i "
     "mandelbrot=size={S}:rate=30 -filter_complex "
     "[0]crop={s}:x=20+2*n:y=90,trim=end_frame=11,setpts=PTS-STARTPTS,format=yuv420p[a];"
     "[1]crop={s}:x=300-3*n:y=n,trim=end_frame=8,fade=out:0:8,setpts=PTS-STARTPTS,format=yuv420p[b];"
     "[2]format=yuv420p,setsar=1[c];[a]setsar=1[d];[b]setsar=1[e];[d][e][c]concat=n=3"},
}};

const Source* find_source(const std::string& name) {
    const auto at = std::find_if(sources.begin(), sources.end(), [&](const Source& s) { return name == s.name; });
    return at == sources.end() ? nullptr : &*at;
}

void replace_all(std::string& text, const std::string& what, const std::string& by) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
        text.replace(at, what.size(), by);
}

}  // namespace

bool is_foreign(const std::string& name) {
    return find_source(name) != nullptr;
}

std::vector<std::string> foreign_source(const std::string& name, const std::string& size,
                                        const std::function<std::string(const std::string&)>& texture) {
    const Source* source = find_source(name);
    EXPECTS(source != nullptr);
    std::string colon = size;
    replace_all(colon, "x", ":");
    std::vector<std::string> words;
    std::istringstream split(source->words);
    for (std::string word; split >> word; words.push_back(word)) {
        replace_all(word, "{S}", size);
        replace_all(word, "{s}", colon);
        if (word.ends_with(".png}")) word = texture(word.substr(1, word.size() - 6));
    }
    return words;
}

void write_foreign(const std::vector<std::string>& source, int pictures, const std::filesystem::path& file) {
    std::vector<std::string> words = {"ffmpeg", "-v", "error", "-nostdin", "-y"};
    words.insert(words.end(), source.begin(), source.end());
    for (const std::string& word :
         {std::string("-frames:v"), std::to_string(pictures), std::string("-pix_fmt"), std::string("yuv420p"),
          std::string("-sws_flags"), std::string("bitexact"), file.string()})
        words.push_back(word);
    run_program(words);
}

}  // namespace render2mpeg::bench
