// The FFmpeg module's only door: hands out its functions.
#include "encoder/av/backend.h"

#include "encoder/av/module/container.h"
#include "encoder/av/module/decoder.h"
#include "encoder/av/module/inspector.h"
#include "encoder/av/module/library_encoder.h"
#include "encoder/av/module/sound_source.h"

namespace render2mpeg::av {
namespace {

class FfmpegBackend final : public Backend {
  public:
    std::unique_ptr<Container> create(const std::filesystem::path& file, const ByteSink& sink, const char* format,
                                      const encoder::Settings& settings, const SequenceFacts& facts,
                                      const Sound& sound) const override {
        return create_container(file, sink, format, settings, facts, sound);
    }
    void decode(const std::filesystem::path& file,
                const std::function<void(const core::Picture&)>& picture) const override {
        decode_film(file, picture);
    }
    void check_film(const std::filesystem::path& name, const char* format, encoder::Codec codec,
                    const Sound& sound) const override {
        check_container(name, format, codec, sound);
    }
    void check_encoder(const encoder::Settings& settings) const override { check_library_encoder(settings); }
    std::unique_ptr<LibraryEncoder> open_encoder(const encoder::Settings& settings,
                                                 const IndexOffsets& offsets) const override {
        return open_library_encoder(settings, offsets);
    }
    int channels_of_sound(const std::filesystem::path& file) const override {
        SoundSource source(file.string());
        source.convert_to(AV_SAMPLE_FMT_FLTP);
        const AudioFifo samples(av_audio_fifo_alloc(AV_SAMPLE_FMT_FLTP, source.channels(), SoundSource::rate));
        while (source.read(samples.get())) av_audio_fifo_reset(samples.get());
        return source.channels();
    }
    Inspection inspect(const std::filesystem::path& file) const override { return inspect_film(file); }
};

}  // namespace
}  // namespace render2mpeg::av

/// The module's only door.
extern "C" const render2mpeg::av::Backend* render2mpeg_av_backend() {
    static const render2mpeg::av::FfmpegBackend backend;
    return &backend;
}
