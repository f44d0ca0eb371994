# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Installs the add-on as users do: from a repository's file: address where Blender has extensions, else from the repository's zip."""
import hashlib
import json
import sys
import urllib.parse
import urllib.request

import addon_utils
import bpy


def install(repository):
    """Subscribes to file:REPOSITORY/index.json, installs and enables what it lists; returns the package."""
    address = "file://" + urllib.request.pathname2url(repository) + "/index.json"
    if hasattr(bpy.ops, "extensions") and bpy.app.version >= (4, 2, 0):
        bpy.context.preferences.system.use_online_access = True  # a file: address counts as that
        repos = bpy.context.preferences.extensions.repos
        made = repos.new(name="Ours", module="ours", remote_url=address)
        index = next(k for k, repo in enumerate(repos) if repo.module == made.module)
        bpy.ops.extensions.repo_sync(repo_index=index)
        assert bpy.ops.extensions.package_install(repo_index=index, pkg_id="render2mpeg", enable_on_install=True) == {"FINISHED"}
        name = "bl_ext.ours.render2mpeg"
    else:
        with urllib.request.urlopen(address) as file:
            row = json.load(file)["data"][0]
        with urllib.request.urlopen(urllib.parse.urljoin(address, row["archive_url"])) as file:
            assert "sha256:" + hashlib.sha256(file.read()).hexdigest() == row["archive_hash"]
        path = urllib.request.url2pathname(urllib.parse.urlparse(urllib.parse.urljoin(address, row["archive_url"])).path)
        bpy.ops.preferences.addon_install(filepath=path, overwrite=True)
        name = "render2mpeg"
        bpy.ops.preferences.addon_enable(module=name)
    assert addon_utils.check(name)[1], addon_utils.check(name)
    return sys.modules[name]
