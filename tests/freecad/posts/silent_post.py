"""A post that gives nothing back."""


def export(objectslist, filename, argstring):
    return None
