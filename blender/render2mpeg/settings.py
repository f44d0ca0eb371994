# SPDX-FileCopyrightText: The render2mpeg authors
# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""What a scene and the preferences say about films, and the program's options for that."""
import bpy

from .program import Refused


def light_words(settings, film):
    """Options of light, of films or of stills, which have no coding that hides anything."""
    words = [] if settings.effort == "DEFAULT" else ["--effort", settings.effort.lower()]
    if settings.tolerance == "FIXED":
        words += ["--tolerance", f"fixed={settings.percent:g}%"]
    elif film and settings.loss != 0.2:
        words += ["--loss", f"{settings.loss:g}"]
    return words


def coding_words(settings):
    words = [] if settings.codec == "ENDING" else ["--codec", settings.codec]
    return words + (["--quantiser", str(settings.quantiser)] if settings.control == "QUANTISER" else [])


def output_of(scene):
    """The film's path."""
    named = scene.render2mpeg.output
    if named.startswith("//") and not bpy.data.filepath:
        raise Refused(f"{named}: save the .blend first, or name a folder for the film")
    return bpy.path.abspath(named)


class Render2mpegSettings(bpy.types.PropertyGroup):
    output: bpy.props.StringProperty(name="Film", subtype="FILE_PATH", default="//film.mpg",
                                     description="The ending chooses the kind: .mp4, .mov and .mkv H.264; .webm VP9; .gif; .mpg, .vob, .ts, .m2v MPEG-2")
    codec: bpy.props.EnumProperty(name="Codec", items=[
        ("ENDING", "By the Ending", "H.264 in .mp4, .mov and .mkv, VP9 in .webm, else MPEG-2"),
        ("mpeg2", "MPEG-2", "DVDs and broadcasts"), ("h264", "H.264", "Plays everywhere"),
        ("hevc", "HEVC", "10 bits"), ("av1", "AV1", "10 bits, smallest")])
    control: bpy.props.EnumProperty(name="Rate", items=[
        ("QUANTISER", "Quantiser", "The same fineness throughout"),
        ("SIZE", "Size", "The finest film that is not larger; by Render Film"),
        ("QUALITY", "Quality", "The coarsest film of this quality; by Render Film")])
    quantiser: bpy.props.IntProperty(name="Quantiser", default=4, min=1, max=31, description="1: fine and large; 31: coarse and small")
    megabytes: bpy.props.FloatProperty(name="Megabytes", default=100, min=0.1)
    decibels: bpy.props.FloatProperty(name="PSNR", default=40, min=20, max=60, description="Of luma, in dB")
    effort: bpy.props.EnumProperty(name="Effort", default="DEFAULT", items=[
        ("DRAFT", "Draft", "Rough light; stills, and films by Render Film"), ("LOW", "Low", "Coarser light, sooner"),
        ("DEFAULT", "Default", "Light as films need it"), ("HIGH", "High", "Finer light, later")])
    tolerance: bpy.props.EnumProperty(name="Tolerance", items=[
        ("HIDDEN", "What Coding Hides", "Light is as exact as the film can show"),
        ("FIXED", "Fixed", "Light is as exact everywhere")])
    loss: bpy.props.FloatProperty(name="Loss", default=0.2, min=0.01, max=6,
                                  description="PSNR-Y in dB that coded pictures may lose by the noise of their light; lower is finer and slower")
    percent: bpy.props.FloatProperty(name="Error", default=2, min=0.1, max=50, subtype="PERCENTAGE",
                                     description="By how much of its luminance a pixel's light may be off")
    report: bpy.props.BoolProperty(name="Report", default=True, description="Write a page about the film beside it")
    open_film: bpy.props.BoolProperty(name="Open When Done", default=True, description="After Render Film")
    folder: bpy.props.StringProperty(name="Folder", subtype="DIR_PATH", default="//film-scene",
                                     description="For rendering elsewhere")


class Render2mpegPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__
    program: bpy.props.StringProperty(name="Program", subtype="FILE_PATH", description="render2mpeg; empty: the one on the PATH")

    def draw(self, _context):
        self.layout.prop(self, "program")


CLASSES = (Render2mpegSettings, Render2mpegPreferences)
