"""Loop conventions of robot files, one module each: what URDF and SDF say in dialects, or beside."""

from vincula.files.dialects.registry import SideFile, reader_of_element, side_files

__all__ = ["SideFile", "reader_of_element", "side_files"]
