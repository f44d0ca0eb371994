#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include "support/program.h"

/// Ninety mistakes that people make, each told in one line that names the cause and the cure. None renders.
namespace render2mpeg {
namespace {

/// What is typed behind the program's name, with what it says: `S` stands for a scene. In a folder that holds a film
/// there.mpg, a text notes.txt, a folder empty, and nothing else.
struct Mistake {
    const char* typed;
    int status;  ///< 2: the command line itself; 1: what files hold
    std::vector<const char*> told;
};

const std::vector<Mistake>& commands() {
    static const std::vector<Mistake> all{
        {"", 2, {"which command?", "render, encode, plan, info, cost, tune, compare"}},
        {"rendr S -o x.mpg", 2, {"rendr is no command", "did you mean render?"}},
        {"rednr S -o x.mpg", 2, {"rednr is no command", "did you mean render?"}},
        {"transcode a.mpg b.mpg", 2, {"transcode is no command", "render, encode, plan"}},
        {"S -o x.mpg", 2, {"is no command", "render2mpeg render", "-o film.mpg"}},
        {"render S -o x.mpg --fog thick", 2, {"--fog", "thick", "off"}},
        {"render S -o x.mpg --fog 0", 2, {"--fog", "above 0"}},
        {"render S -o x.mpg --fog -3", 2, {"--fog", "above 0"}},
        {"render S -o x.mpg --fog inf", 2, {"--fog", "above 0"}},
        {"render S -o x.mpg --projection fisheye", 2, {"--projection", "equirectangular", "vr180"}},
        {"render S -o x.mpg --projection vr180 --f-stop 2 --focus 1", 2, {"--f-stop 2", "a panorama has no lens"}},
        {"render S -o x.mpg --glare bright", 2, {"--glare", "bright", "static:0.2"}},
        {"render S -o x.mpg --glare static:0.7", 2, {"--glare", "0 to 0.5"}},
        {"render S -o x.mpg --grain fine", 2, {"--grain", "fine", "50 to 6400"}},
        {"render S -o x.mpg --grain 49", 2, {"--grain", "50 to 6400"}},
        {"encode S -o x.mpg --grain 6401", 2, {"--grain", "50 to 6400"}},
        {"render S -o x.mpg --grain -100", 2, {"--grain", "50 to 6400"}},
        {"--size 64x64 render S", 2, {"--size", "the command comes first"}},
        {"help rendr", 2, {"rendr is no command", "did you mean render?"}},
        {"render", 2, {"INPUT is missing", "render2mpeg render scene.glb -o film.mpg"}},
        {"render S", 2, {"-o is missing", "-o film.mpg"}},
        {"render -o x.mpg", 2, {"INPUT is missing", "scene.glb"}},
        {"encode -o x.mpg", 2, {"FRAMES is missing", "frames.%04d.png"}},
        {"info", 2, {"FILE is missing", "render2mpeg info film.mpg"}},
        {"plan", 2, {"INPUT is missing", "render2mpeg plan scene.glb"}},
        {"join", 2, {"PLAN is missing", "render2mpeg join film.mpg.farm"}},
        {"part P", 2, {"I is missing", "render2mpeg part film.mpg.farm 1"}},
        {"tune S -o x.mpg", 2, {"what is to be reached?", "--target-psnr", "--max-size"}},
        {"tune S --target-psnr 40", 2, {"which film is to be made?", "-o film.mpg", "--dry-run"}},
        {"render S S -o x.mpg", 2, {"what is this for?"}},
        {"render S x.mpg", 2, {"-o"}},
        {"render S x.mpg -o y.mpg", 2, {"x.mpg", "the film by -o"}},
        {"encode a.png b.png", 2, {"b.png", "one name with a number", "frames.%04d.png"}},
        {"encode a.png b.png -o x.mpg", 2, {"b.png", "one name with a number", "frames.%04d.png"}},
    };
    return all;
}

const std::vector<Mistake>& names() {
    static const std::vector<Mistake> all{
        {"render S -o x.mpg --siz 64x64", 2, {"--siz:", "did you mean --size?"}},
        {"render S -o x.mpg --denoise", 2, {"--denoise:", "no such option; no picture has noise", "--tolerance"}},
        {"render S -o x.mpg --gpu", 2, {"--gpu:", "no such option; light is found by processors"}},
        {"render S -o x.mpg --fov 30", 2, {"--fov:", "no such option; a lens is its camera's"}},
        {"render S -o x.mpg --start 3", 2, {"--start:", "--frames A:B"}},
        {"render S -o x.mpg --width 640", 2, {"--width:", "--size WxH"}},
        {"tune S -o x.mpg --target-size 1", 2, {"--target-size:", "--max-size of `tune`"}},
        {"render S -o x.mpg --quantizer 5", 2, {"--quantizer:", "did you mean --quantiser?"}},
        {"render S -o x.mpg --quantiser=5 --qualty=6", 2, {"--qualty:", "did you mean --quality?"}},
        {"render S -o x.mpg --tolerence 2%", 2, {"--tolerence:", "did you mean --tolerance?"}},
        {"render S -o x.mpg --thread 2", 2, {"--thread:", "did you mean --threads?"}},
        {"render S -o x.mpg -size 64x64", 2, {"-size:", "did you mean --size?"}},
        {"render S -o x.mpg -x 3", 2, {"-x:", "has no such option"}},
        {"render S -o x.mpg --target-psnr 40", 2, {"--target-psnr:", "`tune` has"}},
        {"render S -o x.mpg --tolerances 8,4", 2, {"--tolerances:", "`cost` has", "did you mean --tolerance?"}},
        {"cost S --tolerance 2%", 2, {"--tolerance:", "did you mean --tolerances?"}},
        {"compare S --quantiser 4", 2, {"--quantiser:", "did you mean --quantisers?"}},
        {"encode f.%d.png -o x.mpg --samples 4", 2, {"--samples:", "`render`"}},
        {"info there.mpg --sumary", 2, {"--sumary:", "did you mean --summary?"}},
        {"render S -o x.mpg --zzz", 2, {"--zzz:", "`render` has no such option"}},
    };
    return all;
}

const std::vector<Mistake>& words() {
    static const std::vector<Mistake> all{
        {"render S -o x.mpg --size", 2, {"--size: its value is missing", "WxH"}},
        {"render S -o", 2, {"-o", "missing"}},
        {"render S -o x.mpg --size 64 x 64", 2, {"--size 64: expected WIDTHxHEIGHT"}},
        {"render S -o x.mpg --size 64x64 --size 32x32", 2, {"--size is said more than once", "give one"}},
        {"render S -o x.mpg --quiet=3", 2, {"--quiet takes no value"}},
        {"render S -o x.mpg --quiet --verbose", 2, {"--quiet", "--verbose", "give one"}},
        {"render S -o x.mpg --heatmap tolerance --size 64x64", 2, {"--heatmap tolerance:", "heat.mpg"}},
        {"render S -o x.mpg --heatmap", 2, {"--heatmap:", "heat.mpg"}},
        {"render S -o x.mpg --heatmap colours h.mpg", 2, {"--heatmap colours:", "tolerance, cut, error"}},
    };
    return all;
}

const std::vector<Mistake>& values() {
    static const std::vector<Mistake> all{
        {"render S -o x.mpg --size 640", 2, {"--size 640: expected WIDTHxHEIGHT"}},
        {"render S -o x.mpg --size 0x0", 2, {"--size 0x0: expected WIDTHxHEIGHT"}},
        {"render S -o x.mpg -s 20000x20", 2, {"20000x20: expected WIDTHxHEIGHT"}},
        {"render S -o x.mpg --size 4096x2304", 2, {"size 4096x2304", "at most 1920 columns"}},
        {"render S -o x.mpg --fps 31", 2, {"frame rate 31:", "23.976, 24, 25, 29.97, 30, 50, 59.94, 60"}},
        {"render S -o x.mpg --fps 25fps", 2, {"--fps 25fps:", "0.1 to 240"}},
        {"render S -o x.mpg --frames 9:3", 2, {"--frames 9:3: expected FIRST:LAST"}},
        {"render S -o x.mpg --frames 0-9", 2, {"--frames 0-9: expected FIRST:LAST", "0:47"}},
        {"render S -o x.mpg --frames 100:200", 2, {"--frames 100:200: the film has frames 0 to", "--hold"}},
        {"plan S --frames 0:9999", 2, {"--frames 0:9999: the film has frames 0 to", "--hold"}},
        {"render S -o x.mpg --quantiser 0", 2, {"--quantiser 0: expected a number from 1 to 31"}},
        {"render S -o x.mpg -q 77", 2, {"77: expected a number from 1 to 31"}},
        {"render S -o x.mpg --quantiser fine", 2, {"--quantiser fine: expected a number from 1 to 31"}},
        {"render S -o x.mpg --quality 101", 2, {"--quality 101: expected a number from 0 to 100"}},
        {"render S -o x.mpg --bitrate fast", 2, {"--bitrate fast: expected bits", "1.5M"}},
        {"render S -o x.mpg -b 6 --dry-run", 2, {"--bitrate 6:", "did you mean 6M?"}},
        {"render S -o x.mpg --tolerance 2", 2, {"--tolerance 2: expected", "2%"}},
        {"render S -o x.mpg --tolerance fixed=2", 2, {"--tolerance fixed=2: expected", "fixed=2%"}},
        {"render S -o x.mpg --tolerance 200%", 2, {"--tolerance 200%: expected", "0 to 100"}},
        {"render S -o x.mpg --tolerance coupld", 2, {"--tolerance coupld: expected `coupled`"}},
        {"render S -o x.mpg --exposure bright", 2, {"--exposure bright: expected `auto`", "-64 to 64"}},
        {"render S -o x.mpg --cache maybe", 2, {"--cache maybe: expected on, off, auto"}},
        {"render S -o x.mpg --clamp bound", 2, {"--clamp bound: expected", "did you mean bounded?"}},
        {"render S -o x.mpg --loss 0", 2, {"--loss 0: expected a number from 0.01 to 6"}},
        {"render S -o x.mpg --loss -1", 2, {"--loss -1: expected a number from 0.01 to 6"}},
        {"render S -o x.mpg --loss 0.001", 2, {"--loss 0.001: expected a number from 0.01 to 6"}},
        {"render S -o x.mpg --loss 0.1 --tolerance coupled=1", 2, {"--loss: --tolerance coupled=1", "give one"}},
        {"render S -o x.mpg --masking wraped", 2, {"--masking wraped:", "did you mean warped?"}},
        {"render S -o x.mpg --tune percep", 2, {"--tune percep:", "did you mean perceptual?"}},
        {"render S -o x.mpg --encoder slow", 2, {"--encoder slow: expected fast, quality"}},
        {"render S -o x.mpg --isa mmx", 2, {"--isa mmx:", "sse2, sse4.2, avx, avx2, avx512"}},
        {"render S -o x.mpg --for dvd", 2, {"--for dvd: expected dvd-ntsc, dvd-pal, atsc", "did you mean dvd-"}},
        {"render S -o x.mpg --threads -2", 2, {"--threads -2: expected a number from 0 to 1024"}},
        {"render S -o x.mpg -j many", 2, {"many: expected a number from 0 to 1024"}},
        {"render S -o x.mpg --samples 0", 2, {"--samples 0: expected a number from 1 to 256"}},
        {"render S -o x.mpg --gop 0", 2, {"--gop 0: expected a number from 1 to 1000"}},
        {"render S -o x.mpg --display-aspect wide", 2, {"--display-aspect wide: expected WIDTH:HEIGHT", "16:9"}},
        {"render S -o x.mpg --memory lots", 2, {"--memory lots: expected a size such as 8G"}},
        {"render S -o x.mpg --memory 10M", 2, {"--memory 10M: no film is rendered in less than 16M"}},
        {"render S -o x.mpg --keyframes a,b", 2, {"--keyframes a,b: expected frame numbers", "0,48,96"}},
        {"render S -o x.mpg --audio-offset later", 2, {"--audio-offset later: expected a number from"}},
        {"cost S --tolerances 8,,2", 2, {"--tolerances 8,,2: expected per cent", "8,4,2,1"}},
        {"compare S --beside cycles", 2, {"--beside cycles", "Cycles renders .blend files"}},
        {"compare S --beside arnold", 2, {"--beside", "arnold", "cycles"}},
        {"compare S --quantisers 40", 2, {"--quantisers 40: expected numbers from 1 to 31"}},
        {"cost S --sample 3", 2, {"--sample 3: expected WINDOWSxFRAMES", "2x3"}},
        {"tune S --target-psnr 400 --dry-run", 2, {"--target-psnr 400: expected a number from 1 to 99"}},
        {"tune S --max-time soon --dry-run", 2, {"--max-time soon: expected hours, minutes and seconds", "1:30"}},
        {"tune S --max-size huge --dry-run", 2, {"--max-size huge: expected bytes", "700M"}},
    };
    return all;
}

const std::vector<Mistake>& contradictions() {
    static const std::vector<Mistake> all{
        {"render S -o x.mpg --quantiser 4 --quality 50", 2, {"--quantiser and --quality", "give one"}},
        {"render S -o x.mpg --quality 50 --bitrate 1M", 2, {"--quality and --bitrate", "give one"}},
        {"render S -o x.mpg --cbr", 2, {"--cbr:", "--bitrate 6M"}},
        {"render S -o x.mpg --bitrate 0.2k", 2, {"--bitrate 0.2k:", "at least 400"}},
        {"render S -o x.mpg --bitrate 6", 2, {"at least 400", "did you mean 6M?"}},
        {"render S -o x.mpg --bitrate 200", 2, {"at least 400", "did you mean 200k?"}},
        {"render S -o x.mpg --effort draft --aov d", 2, {"--aov: with --effort draft there are no layers"}},
        {"render S -o x.mpg --preview --aov d", 2, {"--aov: with --preview there are no layers"}},
        {"render S -o x.mpg --passes 2", 2, {"--passes:", "--bitrate"}},
        {"render S -o x.mpg --display-aspect 4:3 --pixel-aspect 1:1",
         2,
         {"--pixel-aspect", "--display-aspect", "give one"}},
        {"render S -o x.mpg --for dvd-pal --size 640x480", 2, {"--size 640x480:", "720x576"}},
        {"render S -o x.mpg --for dvd-pal --fps 30", 2, {"--fps 30:", "dvd-pal has 25"}},
        {"render S -o f.%d.png --tolerance coupled", 2, {"--tolerance coupled:", "fixed=P%"}},
        {"tune S --target-psnr 40 --target-ssim 0.9 --dry-run", 2, {"Give one of --target-psnr"}},
        {"render S -o x.webm --level 4.1", 2, {"--level 4.1: VP9's follows from size and rate", "--codec h264"}},
        {"tune S -o x.gif --target-psnr 40", 2, {"GIF: a master has no quantisers to try", "`render`"}},
        {"tune S --target-psnr 40 --quality 3 --dry-run", 2, {"--quality: it is what is looked for"}},
        {"render S -o x.wmv", 2, {"x.wmv", ".wmv is not written", ".mp4 or .mkv"}},
        {"render S -o x.jpg", 2, {"x.jpg", "only .png and .exr"}},
        {"render S -o x.mp3", 2, {"x.mp3", "it would be sound", "--audio"}},
        {"render S -o x.glb", 2, {"x.glb", "it would be a scene", "-o film.mpg"}},
        {"render S -o x.xyz", 2, {"x.xyz", ".mpg, .vob, .ts"}},
        {"render S -o x.mpg --effort lots", 2, {"--effort lots: expected draft, low, default, high"}},
        {"tune S --target-psnr 40 --of best --dry-run", 2, {"--of best: expected film, worst-tenth"}},
        {"render S -o x.png", 2, {"x.png", "frames.%04d.png"}},
        {"render S -o empty", 2, {"empty", "needs an ending", "empty.mpg"}},
        {"render S -o \"\"", 2, {"a word of the command is empty", "variable"}},
        {"render S -o x.mpg --fps 26", 2, {"frame rate 26: MPEG-2 has", "29.97", "--codec h264"}},
        {"render S -o x.mpg --size 99999x8", 2, {"--size 99999x8", "from 1 to 16383"}},
        {"render S -o x.mpg --view Filmic", 2, {"--view Filmic", "did you mean filmic?"}},
        {"render S -o x.mpg --transparent yes", 2, {"--transparent yes: expected on, off"}},
        {"encode f.%d.png -o x.webm --transparent no", 2, {"--transparent no: expected on, off"}},
        {"render S -o x.mpg --keyframes none.txt", 2, {"none.txt: expected frame numbers", "there is no such file"}},
        {"render S -o x.mpg --keyframes /dev/zero", 2, {"/dev/zero: expected frame numbers", "it is a device"}},
        {"farm S -o x.mpg", 2, {"--to is missing", "slurm", "flamenco"}},
        {"farm S -o - --to slurm", 2, {"-o -", "-o film.mpg"}},
    };
    return all;
}

const std::vector<Mistake>& files() {
    static const std::vector<Mistake> all{
        {"render ./plain_bx -o x.mpg", 1, {"./plain_bx", "there is no such file"}},
        {"render note.txt -o x.mpg", 1, {"note.txt", "did you mean notes.txt?"}},
        {"render notes.txt -o x.mpg", 1, {"notes.txt", "it is no scene", ".blend, .glb"}},
        {"render notes.xyz -o x.mpg", 1, {"notes.xyz", "no kind of scene that is known"}},
        {"render there.mpg -o x.mpg", 1, {"there.mpg", "it is a film already", ".blend, .glb"}},
        {"render shot.png -o x.mpg", 1, {"shot.png", "it is a picture", "encode frames.%04d.png"}},
        {"render song.wav -o x.mpg", 1, {"song.wav", "it is sound", "--audio"}},
        {"render old.blend1 -o x.mpg", 1, {"old.blend1", "backup", "rename it to .blend"}},
        {"render empty -o x.mpg", 1, {"empty", "neither a film.json nor a scene"}},
        {"render . -o x.mpg", 1, {"this folder holds no film.json", "./room.blend"}},
        {"plan notes.txt", 1, {"notes.txt", "it is no scene"}},
        {"cost there.mpg", 1, {"there.mpg", "it is a film already"}},
        {"watch nothing.glb", 1, {"nothing.glb", "there is no such file"}},
        {"watch notes.txt -o d.mpg", 1, {"notes.txt", "it is no scene"}},
        {"info room.blend", 1, {"room.blend", "it is a scene, not a film", "`plan`"}},
        {"info shot.png", 1, {"shot.png", "it is a picture, not a film"}},
        {"info empty", 1, {"empty", "it is a folder"}},
        {"render S -o none/x.mpg", 1, {"none/x.mpg", "there is no folder none", "-y makes it"}},
        {"render S -o x.mpg --stats none/x.json", 1, {"none/x.json", "there is no folder none", "-y makes it"}},
        {"render S -o there.mpg", 1, {"there.mpg", "is there already", "-y replaces it"}},
        {"tune S -o there.mpg --target-psnr 40", 1, {"there.mpg", "is there already", "-y replaces it"}},
        {"render S -o x.mpg --heatmap cut there.mpg", 1, {"there.mpg", "is there already", "-y replaces it"}},
        {"render S -o x.mpg --report r.txt", 1, {"r.txt", ".html"}},
        {"render S -o x.mpg --stats x.mpg", 1, {"x.mpg", "two outputs have this name"}},
        {"render S -o x.mpg --camera nobody", 1, {"no camera \"nobody\"", "0 \"camera\""}},
        {"render S -o x.mpg --also foo y.mov", 2, {"--also: view foo: expected one of"}},
        {"render S -o x.mpg --sky /dev/zero", 1, {"/dev/zero: it is a device; plain files alone are read"}},
        {"render S -o x.mpg --audio /dev/zero", 1, {"/dev/zero: it is a device; plain files alone are read"}},
        {"render S -o x.mpg --sky none.exr", 1, {"none.exr", "there is no such file"}},
        {"render S -o x.mpg --audio none.flac", 1, {"none.flac", "there is no such file"}},
        {"info notes.txt", 1, {"notes.txt", "neither a film nor sound that can be read"}},
        {"render tie.glb -o x.mpg", 1, {"tie.glb: it is a link to nowhere.glb, which is not there"}},
        {"render tube.glb -o x.mpg", 1, {"tube.glb: it is a pipe or a device"}},
        {"render worn.obj -o x.mpg", 1, {"worn.obj: it is damaged, or is not what its name says"}},
        {"render S -o x.mpg --audio worn.obj", 1, {"worn.obj: what it holds is neither a film nor sound"}},
        {"render S -o x.mpg --last-frame x.jpg", 1, {"--last-frame x.jpg: it is a .png"}},
        {"info nothing.mpg", 1, {"nothing.mpg", "there is no such file"}},
        {"render S -o x.mpg --stats notes.txt", 1, {"notes.txt", "is there already", "-y replaces it"}},
        {"cost S --json notes.txt", 1, {"notes.txt", "is there already", "-y replaces it"}},
        {"encode there.mpg -o x.mpg", 1, {"there.mpg: it is coded", "`ffmpeg -i there.mpg -f yuv4mpegpipe - |"}},
        {"plan zeros.glb", 1, {"zeros.glb: it is empty, or damaged"}},
        {"encode frames.png -o x.mpg", 1, {"frames.png", "frames.%04d.png"}},
        {"encode f.%d.png -o x.mpg", 1, {"f.%d.png", "no file has such a name"}},
    };
    return all;
}

std::string with_scene(const std::string& typed) {
    std::string text;
    for (std::size_t i = 0; i < typed.size(); ++i) {
        const bool alone =
            typed[i] == 'S' && (i == 0 || typed[i - 1] == ' ') && (i + 1 == typed.size() || typed[i + 1] == ' ');
        text += alone ? support::plain_film() : std::string(1, typed[i]);
    }
    return text;
}

class Mistakes : public testing::TestWithParam<const std::vector<Mistake>*> {};

TEST_P(Mistakes, AreToldInOneLineWithTheirCure) {
    const support::Folder folder;
    std::ofstream(folder / "there.mpg") << "a film";
    std::ofstream(folder / "notes.txt") << "no scene\n";
    for (const char* name : {"notes.xyz", "shot.png", "song.wav", "old.blend1", "stage.usd", "room.blend"})
        std::ofstream(folder / name) << "not looked into\n";
    std::ofstream(folder / "worn.obj") << '\1';
    std::ofstream(folder / "zeros.glb") << std::string(100, '\0');
    std::filesystem::create_directory(folder / "empty");
    std::filesystem::create_symlink("nowhere.glb", folder / "tie.glb");
    ASSERT_EQ(mkfifo((folder / "tube.glb").c_str(), 0600), 0);
    const std::size_t before = folder.entries();
    for (const Mistake& mistake : *GetParam()) {
        const auto outcome = support::run("cd " + folder.path().string() + " && " + support::program() + " " +
                                          with_scene(mistake.typed));
        EXPECT_EQ(outcome.status, mistake.status) << mistake.typed << "\n" << outcome.output;
        EXPECT_TRUE(outcome.output.starts_with("render2mpeg: ")) << mistake.typed << "\n" << outcome.output;
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
        for (const char* words : mistake.told)
            EXPECT_NE(outcome.output.find(words), std::string::npos) << mistake.typed << ": " << words << "\n"
                                                                     << outcome.output;
        EXPECT_EQ(folder.entries(), before) << mistake.typed;
    }
}

INSTANTIATE_TEST_SUITE_P(Of, Mistakes,
                         testing::Values(&commands(), &names(), &words(), &values(), &contradictions(), &files()));

TEST(Watching, WithoutADisplayIsRefused) {
    const auto outcome = support::run("timeout 60 env -u DISPLAY -u WAYLAND_DISPLAY -u SDL_VIDEODRIVER " +
                                      support::program() + " watch " + support::plain_film());
    EXPECT_EQ(outcome.status, 1);
    EXPECT_NE(outcome.output.find("there is no display; -o draft.mp4 writes each draft"), std::string::npos)
        << outcome.output;
}

TEST(Mistakes100, AreThatMany) {
    std::size_t count = 0;
    for (const auto* list : {&commands(), &names(), &words(), &values(), &contradictions(), &files()})
        count += list->size();
    EXPECT_GE(count, 100u);
}

}  // namespace
}  // namespace render2mpeg
