"""What is taught: the correction from plugs put in by hand, and turns about the flange's axis.

``teaching`` makes a correction, ``taught`` applies it, ``taught_check`` tries it on plugs that it
was not made from. ``made_with`` says which devices and calibrations a taught result belongs to.
"""
